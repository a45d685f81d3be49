//! What has been drawn and stays: a frame of its own that strokes are added to and that slowly fades.

use crate::graphics::{Canvas, HEIGHT, Row, Stroke};

/// How ink fades: every row loses one grey in [`HEIGHT`]/`rows` ticks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fading {
    /// Rows that lose a grey in a tick.
    pub rows: u8,
    /// Grey that ink fades to and keeps.
    pub last: u8,
}

impl Fading {
    pub const NEVER: Self = Self { rows: 0, last: 15 };
    /// A trace that stays: it loses a grey in about a second.
    pub const TRACE: Self = Self { rows: 1, last: 4 };
}

#[derive(Clone, Debug)]
pub struct FadeLayer {
    pub frame: Canvas,
    row: i32,
}

impl FadeLayer {
    pub const NONE: Self = Self { frame: Canvas::BLACK, row: 0 };

    pub fn clear(&mut self) {
        self.frame.clear();
        self.row = 0;
    }

    /// Adds a stroke with a brightness of 0 to 255.
    #[inline(never)]
    pub fn add(&mut self, stroke: Stroke, brightness: u8) {
        stroke.lighten(&mut self.frame, brightness);
    }

    #[inline(never)]
    pub fn fade(&mut self, Fading { rows, last }: Fading) {
        for _ in 0..rows {
            if let Some(Row(row)) = self.frame.row_mut(self.row) {
                let words = row.as_chunks_mut().0.iter_mut();
                words.for_each(|word| *word = paled(u32::from_ne_bytes(*word), last).to_ne_bytes());
            }
            self.row = (self.row + 1) % HEIGHT as i32;
        }
    }
}

/// Eight greys at once: each that is above `last` loses 1.
#[inline]
fn paled(greys: u32, last: u8) -> u32 {
    const ONES: u32 = 0x0101_0101;
    // Added to a grey above `last`, and to no other, it carries out of the nibble.
    let room = u32::from(15_u8.saturating_sub(last)) * ONES;
    let above = |every_other: u32| (((every_other & (15 * ONES)) + room) >> 4) & ONES;
    greys - above(greys) - (above(greys >> 4) << 4)
}
