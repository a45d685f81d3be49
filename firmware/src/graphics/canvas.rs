//! The frame: 128 x 64 pixels of 16 greys, in the layout the panel itself uses; and the layer of what stays and fades.

pub const WIDTH: usize = 128;
pub const HEIGHT: usize = 64;
const ROW: usize = WIDTH / 2;

/// A row of pixels from the left, two in a byte: the high nibble is the left one. It stands at a word's boundary, so that it is
/// copied and compared by words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(4))]
pub struct Row(pub [u8; ROW]);

/// Rows from the top. Drawing cannot fail: what lies outside is not drawn.
#[derive(Debug, PartialEq, Eq)]
pub struct Canvas {
    pub rows: [Row; HEIGHT],
    /// Whether every grey matters, as in a picture; a drawing is bright on dark.
    pub all_greys: bool,
}

impl Default for Canvas {
    fn default() -> Self {
        Self::BLACK
    }
}

impl Clone for Canvas {
    fn clone(&self) -> Self {
        Self {
            rows: self.rows,
            all_greys: self.all_greys,
        }
    }

    /// Row by row, in half the time of the library's `memcpy`.
    fn clone_from(&mut self, source: &Self) {
        self.all_greys = source.all_greys;
        for (Row(row), Row(from)) in self.rows.iter_mut().zip(&source.rows) {
            let ((left, right), (from_left, from_right)) =
                (row.split_at_mut(ROW / 2), from.split_at(ROW / 2));
            right.copy_from_slice(from_right);
            left.copy_from_slice(from_left);
        }
    }
}

impl Canvas {
    pub const BLACK: Self = Self {
        rows: [Row([0; ROW]); HEIGHT],
        all_greys: false,
    };

    /// The bytes as the panel takes them.
    pub fn bytes(&self) -> impl Iterator<Item = u8> + Clone {
        self.rows.iter().flat_map(|Row(row)| *row)
    }

    /// A row from the top; none outside.
    #[inline]
    pub fn row_mut(&mut self, y: i32) -> Option<&mut Row> {
        // What is negative is far beyond the end.
        self.rows.get_mut(y as usize)
    }

    /// Moves every pixel from column `left` on to the left by one; what is left of them stays black, and the last column is
    /// black.
    #[inline(never)]
    pub fn scroll(&mut self, left: i32) {
        for row in &mut self.rows {
            let mut from_right = 0;
            for word in row.0.as_chunks_mut().0.iter_mut().rev() {
                let greys = u32::from_be_bytes(*word);
                *word = (greys << 4 | from_right).to_be_bytes();
                from_right = greys >> 28;
            }
            row.update(left - 1, |_| 0);
        }
    }

    /// The grey of a pixel, 0 to 15; `None` outside.
    pub fn get(&self, x: i32, y: i32) -> Option<u8> {
        let Row(row) = self.rows.get(y as usize)?;
        Some((row.get((x >> 1) as usize)? >> shift(x)) & 0x0F)
    }

    /// Replaces the grey of a pixel by a function of it; of the result only the low four bits count.
    #[inline]
    pub fn update(&mut self, x: i32, y: i32, new: impl FnOnce(u8) -> u8) {
        if let Some(row) = self.row_mut(y) {
            row.update(x, new);
        }
    }

    #[inline]
    pub fn lighten(&mut self, x: i32, y: i32, grey: u8) {
        if let Some(row) = self.row_mut(y) {
            row.lighten(x, grey);
        }
    }

    /// Gives pixels one grey: of 8 x 8 from (x, y) on those whose bits are set, the first row in the highest byte, in each the
    /// leftmost pixel in the highest bit.
    #[inline(never)]
    pub fn stamp(&mut self, x: i32, mut y: i32, mut bits: u64, grey: u8) {
        let (word, shift) = ((x >> 3) as usize, 4 * (x & 7));
        let greys = u32::from(grey) * 0x1111_1111;
        while bits != 0 {
            if let Some(Row(row)) = self.row_mut(y) {
                let pixels = nibbles((bits >> 56) as u32);
                for (word, part) in [
                    (word, pixels >> shift),
                    (word.wrapping_add(1), (pixels << 1) << (31 - shift)),
                ] {
                    if part != 0
                        && let Some(eight) = row.as_chunks_mut().0.get_mut(word)
                    {
                        let part = u32::from_ne_bytes(part.to_be_bytes());
                        let old = u32::from_ne_bytes(*eight);
                        *eight = (old ^ ((old ^ greys) & part)).to_ne_bytes();
                    }
                }
            }
            (bits, y) = (bits << 8, y.wrapping_add(1));
        }
    }
}

impl Row {
    #[inline]
    pub fn update(&mut self, x: i32, new: impl FnOnce(u8) -> u8) {
        if let Some(pair) = self.0.get_mut((x >> 1) as usize) {
            let old = (*pair >> shift(x)) & 0x0F;
            *pair ^= (old ^ (new(old) & 0x0F)) << shift(x);
        }
    }

    /// Gives a pixel a grey of 0 to 15; if it is brighter already, it stays.
    #[inline]
    pub fn lighten(&mut self, x: i32, grey: u8) {
        self.update(x, |old| old.max(grey));
    }
}

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

/// What stays of the frames before.
#[derive(Clone, Debug)]
pub struct FadeLayer {
    pub frame: Canvas,
    row: i32,
}

impl FadeLayer {
    pub const NONE: Self = Self {
        frame: Canvas::BLACK,
        row: 0,
    };

    #[inline(never)]
    pub fn fade(&mut self, Fading { rows, last }: Fading) {
        let room = u32::from(15_u8.saturating_sub(last)) * ONES;
        for _ in 0..rows {
            if let Some(Row(row)) = self.frame.row_mut(self.row) {
                for word in row.as_chunks_mut().0 {
                    let greys = u32::from_ne_bytes(*word);
                    let paled = greys - carried(greys, room) - (carried(greys >> 4, room) << 4);
                    *word = paled.to_ne_bytes();
                }
            }
            self.row = (self.row + 1) % HEIGHT as i32;
        }
    }
}

/// One in every other nibble.
const ONES: u32 = 0x0101_0101;

/// Every other one of eight greys, from the lowest: 1 where adding `room` to it carries out of its nibble.
#[inline(always)]
pub(super) fn carried(greys: u32, room: u32) -> u32 {
    (((greys & (15 * ONES)) + room) >> 4) & ONES
}

/// How far left in its byte a pixel's nibble lies.
#[inline]
fn shift(x: i32) -> u32 {
    4 * (!x as u32 & 1)
}

/// Of eight bits each as a nibble.
#[inline]
fn nibbles(bits: u32) -> u32 {
    let fours = (bits | bits << 12) & 0x000F_000F;
    let twos = (fours | fours << 6) & 0x0303_0303;
    15 * ((twos | twos << 3) & 0x1111_1111)
}
