//! The format of a panel: its size, and the size of its text.

use core::ops::Range;

use crate::graphics::PANEL;

/// The size of a panel, and of a pixel of its text. Scenes compute their layout from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Format {
    /// The width, pixels, a multiple of 8.
    pub width: u16,
    /// The height, pixels.
    pub height: u16,
    /// The size of a pixel of the text, pixels. Lines and gaps have this size, too.
    pub unit: u8,
}

impl Default for Format {
    fn default() -> Self {
        Self::OLED
    }
}

/// The format that a board's program is built for, so that the compiler leaves out the layouts of
/// the others: they take 10 KB of flash, and their arithmetic half of the time to draw. A host and a
/// browser know the format only at run time.
const BUILT_FOR: Option<Format> = if cfg!(target_os = "none") {
    Some(PANEL.format())
} else {
    None
};

impl Format {
    /// The format of the OLED panels, 128 x 64.
    pub const OLED: Self = Self::new(128, 64, 1);

    /// Returns a format. Nothing is checked.
    pub const fn new(width: u16, height: u16, unit: u8) -> Self {
        Self {
            width,
            height,
            unit,
        }
    }

    /// Returns this format, as a constant on a board.
    pub const fn known(self) -> Self {
        match BUILT_FOR {
            Some(format) => format,
            None => self,
        }
    }

    /// Returns the number of words of eight pixels in a row of a layer.
    pub const fn row_words(self) -> usize {
        self.known().width as usize / 8
    }

    /// Returns the number of words in all rows of a layer.
    pub const fn words(self) -> usize {
        self.row_words() * self.known().height as usize
    }

    /// Returns the words of row `y`; `None` outside the panel.
    pub fn row_range(self, y: usize) -> Option<Range<usize>> {
        (y < self.known().height.into()).then(|| {
            let first = y * self.row_words();
            first..first + self.row_words()
        })
    }

    /// Returns the width, pixels.
    pub const fn right(self) -> i32 {
        self.known().width as i32
    }

    /// Returns the height, pixels.
    pub const fn bottom(self) -> i32 {
        self.known().height as i32
    }

    /// Returns this number of units in pixels.
    pub const fn units(self, units: i32) -> i32 {
        units * self.known().unit as i32
    }

    /// Returns the height of a line of text, pixels.
    pub const fn line(self) -> i32 {
        self.units(8)
    }

    /// Returns the top row of the lowest line of text. A margin of one unit is below the line.
    pub const fn lowest(self) -> i32 {
        self.bottom() - self.units(9)
    }

    /// Returns true for panels larger than an OLED. They have room for a line of text at the top
    /// and one at the bottom that nothing else reaches.
    pub const fn is_large(self) -> bool {
        self.known().unit > 1
    }

    /// Returns true if a pendulum and a plot have more room one below the other.
    pub const fn is_tall(self) -> bool {
        4 * self.known().height >= 3 * self.known().width
    }
}
