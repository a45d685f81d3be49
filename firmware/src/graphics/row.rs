//! A row of a canvas, and the levels of its pixels.

use core::ops::Range;

/// The level that covers the ink with black, in the foreground of a colour panel. 0 is transparent.
const BLACK: u8 = 1;
/// The number 1 in every nibble.
const ONES: u32 = 0x1111_1111;

/// A tool that changes pixels of a layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pen {
    /// True for a foreground that is transparent where nothing is drawn.
    pub(super) is_apart: bool,
}

impl Pen {
    /// Returns the level that shows this grey.
    fn level(self, grey: u8) -> u8 {
        if self.is_apart { grey.max(BLACK) } else { grey }
    }

    /// Returns a word of eight pixels that all show this grey.
    pub(super) fn greys(self, grey: u8) -> u32 {
        u32::from(self.level(grey)) * ONES
    }

    /// Returns the grey of pixel `x` in its word, or in a covered word where that is transparent.
    fn grey(self, word: u32, covered: Option<&u32>, x: i32) -> u8 {
        let level = |word: u32| (word >> shift(x) & 15) as u8;
        match covered {
            Some(covered) => shown(level(*covered), level(word)),
            None => level(word),
        }
    }

    /// Sets pixel `x` in its word to a grey, unless it is brighter.
    #[inline]
    pub(super) fn lighten(self, word: &mut u32, covered: Option<&u32>, x: i32, grey: u8) {
        if self.level(grey) > self.level(self.grey(*word, covered, x)) {
            put(word, x, grey);
        }
    }
}

/// A row of a canvas, for drawing on one layer.
#[derive(Debug)]
pub struct Row<'c> {
    pub(super) words: &'c mut [u32],
    /// The words of the covered layer, or none.
    pub(super) covered: &'c [u32],
    pub(super) pen: Pen,
}

impl Row<'_> {
    /// Replaces the grey of the pixel in column `x` by a function of it. Only the low four bits of
    /// the result count. The function is not called for a pixel outside the row.
    pub(super) fn update(&mut self, x: i32, new: impl FnOnce(u8) -> u8) {
        // A negative number becomes a word far beyond the end.
        let place = (x >> 3) as usize;
        if let Some(word) = self.words.get_mut(place) {
            let old = self.pen.grey(*word, self.covered.get(place), x);
            let new = new(old) & 15;
            if new != old {
                put(word, x, self.pen.level(new));
            }
        }
    }

    /// Sets pixels to a grey of 0 to 15. They then cover the ink, also if that has the same grey.
    #[inline]
    pub fn fill(&mut self, columns: Range<i32>, grey: u8) {
        let greys = self.pen.greys(grey);
        let Range { mut start, end } = columns;
        while start < end {
            let from = u32::MAX >> (4 * (start & 7));
            let beyond = (start | 7) + 1 - end;
            let to = u32::MAX << (4 * beyond.max(0));
            // A negative number becomes a word far beyond the end.
            if let Some(word) = self.words.get_mut((start >> 3) as usize) {
                *word ^= (*word ^ greys) & (from & to).to_be();
            }
            start = (start | 7) + 1;
        }
    }

    /// Sets a pixel to a grey of 0 to 15. A pixel that is brighter already keeps its grey.
    #[inline]
    pub fn lighten(&mut self, x: i32, grey: u8) {
        let place = (x >> 3) as usize;
        if let Some(word) = self.words.get_mut(place) {
            self.pen.lighten(word, self.covered.get(place), x, grey);
        }
    }
}

/// Returns the grey that these levels show.
pub(super) fn shown(ink: u8, foreground: u8) -> u8 {
    match foreground {
        0 => ink,
        BLACK => 0,
        grey => grey,
    }
}

/// Sets pixel `x` in its word to a level.
fn put(word: &mut u32, x: i32, level: u8) {
    let shift = shift(x);
    *word = *word & !(15 << shift) | u32::from(level) << shift;
}

/// Returns the position of a pixel's nibble in its word, as a shift.
pub(super) fn shift(x: i32) -> u32 {
    4 * (x as u32 & 7 ^ 1)
}

/// Returns each of eight bits as a nibble of 0 or 15 of a word in memory, the highest bit on the
/// left.
pub(super) fn nibbles(bits: u32) -> u32 {
    let fours = (bits | bits << 12) & 0x000F_000F;
    let twos = (fours | fours << 6) & 0x0303_0303;
    (15 * ((twos | twos << 3) & ONES)).to_be()
}
