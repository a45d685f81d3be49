//! What has been drawn and stays: a picture of its own that strokes are added to and that slowly pales.

use crate::brush::Stroke;
use crate::canvas::{Canvas, HEIGHT, WIDTH};

/// Grey that ink pales down to and keeps.
const LAST_GREY: u8 = 4;

/// A picture that fades: every row loses one grey in [`HEIGHT`] ticks, about a second.
#[derive(Clone, Debug)]
pub struct Ink {
    picture: Canvas,
    /// The row that pales next.
    row: u8,
}

impl Ink {
    /// Nothing has been drawn.
    pub const NONE: Self = Self { picture: Canvas::BLACK, row: 0 };

    /// Wipes it all out.
    pub fn clear(&mut self) {
        self.picture.clear();
        self.row = 0;
    }

    /// Adds a stroke at full brightness.
    pub fn add(&mut self, stroke: Stroke) {
        stroke.lighten(&mut self.picture, u8::MAX);
    }

    /// Pales one row.
    pub fn tick(&mut self) {
        let y = i32::from(self.row);
        for x in 0..WIDTH as i32 {
            self.picture.update(x, y, |grey| if grey > LAST_GREY { grey - 1 } else { grey });
        }
        self.row = (self.row + 1) % HEIGHT as u8;
    }

    /// What is there now.
    pub fn picture(&self) -> &Canvas {
        &self.picture
    }
}
