//! What has been drawn and stays: a frame of its own that strokes are added to and that slowly pales.

use crate::graphics::brush::Stroke;
use crate::graphics::canvas::{Canvas, HEIGHT};

/// Grey that ink pales down to and keeps.
const LAST_GREY: u8 = 4;

/// A frame that fades: every row loses one grey in [`HEIGHT`] ticks, about a second.
#[derive(Clone, Debug)]
pub struct FadeLayer {
    frame: Canvas,
    /// The row that pales next.
    row: u8,
}

impl FadeLayer {
    /// Nothing has been drawn.
    pub const NONE: Self = Self { frame: Canvas::BLACK, row: 0 };

    /// Wipes it all out.
    pub fn clear(&mut self) {
        self.frame.clear();
        self.row = 0;
    }

    /// Adds a stroke at full brightness.
    pub fn add(&mut self, stroke: Stroke) {
        stroke.lighten(&mut self.frame, u8::MAX);
    }

    /// Pales one row.
    pub fn tick(&mut self) {
        for pair in self.frame.row_mut(self.row.into()) {
            let [left, right] = [*pair >> 4, *pair & 0x0F].map(|grey| grey - u8::from(grey > LAST_GREY));
            *pair = left << 4 | right;
        }
        self.row = (self.row + 1) % HEIGHT as u8;
    }

    /// What is there now.
    pub fn frame(&self) -> &Canvas {
        &self.frame
    }
}
