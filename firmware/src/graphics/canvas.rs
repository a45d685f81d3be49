//! The canvas, 128 x 64 pixels of 16 greys in the memory layout of the panel, and the fade layer,
//! which holds the traces of earlier frames.

/// The width of the canvas, pixels.
pub const WIDTH: usize = 128;
/// The height of the canvas, pixels.
pub const HEIGHT: usize = 64;
/// The size of a row, bytes.
const ROW: usize = WIDTH / 2;

/// A row of 128 pixels from the left in 64 bytes, two in each. The high nibble is the left pixel.
/// Pixels outside the row are ignored. Greys are 0 (black) to 15. This is not checked.
///
/// The row is aligned to a word, so that it can be copied and compared by words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(4))]
pub struct Row(pub [u8; ROW]);

/// The rows of pixels from the top. Drawing cannot fail: pixels outside the canvas are ignored.
///
/// Not checked: greys are 0 (black) to 15. A larger one gives wrong greys; in
/// [`stamp`](Self::stamp) it overflows, which panics in a build with overflow checks.
#[derive(Debug, PartialEq, Eq)]
pub struct Canvas {
    /// The rows from the top.
    pub rows: [Row; HEIGHT],
    /// True if every grey matters, as in a picture. False for a drawing, which is bright on dark.
    /// Only a panel of one colour shows the difference: it shows the greys of a picture as patterns
    /// of dots, but most greys of a drawing as off or on ([`Bitmap`](crate::graphics::Bitmap)).
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

    /// Copies row by row, in half the time of the library's `memcpy`.
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
    /// A canvas whose pixels are all 0, for a drawing.
    pub const BLACK: Self = Self {
        rows: [Row([0; ROW]); HEIGHT],
        all_greys: false,
    };

    /// Returns the bytes of the rows from the top, 4,096 in all: two pixels in each, the left one
    /// in the high nibble.
    pub fn bytes(&self) -> impl Iterator<Item = u8> + Clone {
        self.rows.iter().flat_map(|Row(row)| *row)
    }

    /// Returns row `y`, counted from the top; `None` outside the canvas.
    pub fn row_mut(&mut self, y: i32) -> Option<&mut Row> {
        // A negative number becomes an index far beyond the end.
        self.rows.get_mut(y as usize)
    }

    /// Moves all pixels to the left by one column. Column `left - 1` and the last column become
    /// black; the first column is lost.
    ///
    /// So the pixels from column `left` on scroll out at their left end, if the columns before
    /// `left` are black, as they must be: they move, too. With a `left` of 0, or outside the
    /// canvas, the whole canvas scrolls.
    #[inline(never)] // Test `scenes` profiles it by its name.
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

    /// Returns the grey of the pixel in column `x` and row `y`, 0 to 15; `None` outside the canvas.
    pub fn get(&self, x: i32, y: i32) -> Option<u8> {
        let Row(row) = self.rows.get(y as usize)?;
        Some((row.get((x >> 1) as usize)? >> shift(x)) & 0x0F)
    }

    /// Replaces the grey of the pixel in column `x` and row `y` by a function of it. Only the low
    /// four bits of the result count. The function is not called for a pixel outside the canvas.
    pub fn update(&mut self, x: i32, y: i32, new: impl FnOnce(u8) -> u8) {
        if let Some(row) = self.row_mut(y) {
            row.update(x, new);
        }
    }

    /// Sets a pixel to a grey of 0 to 15. A pixel that is brighter already keeps its grey.
    pub fn lighten(&mut self, x: i32, y: i32, grey: u8) {
        if let Some(row) = self.row_mut(y) {
            row.lighten(x, grey);
        }
    }

    /// Sets pixels to one grey, 0 to 15, brighter ones, too: the pixels whose bits are set, of the
    /// 8 x 8 to the right of column `x` and below row `y`, both included. The others are unchanged.
    /// The first row is in the highest byte, and the leftmost pixel of a row is in its highest bit.
    #[inline(never)] // Inlined, it takes 336 bytes of flash (M3).
    pub fn stamp(&mut self, x: i32, mut y: i32, mut bits: u64, grey: u8) {
        let word = (x >> 3) as usize;
        let shift = 4 * (x & 7);
        let greys = u32::from(grey) * 0x1111_1111;

        while bits != 0 {
            if let Some(Row(row)) = self.row_mut(y) {
                // The eight pixels of a row are in one word of the canvas, or in two neighbouring
                // ones.
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
            bits <<= 8;
            y = y.wrapping_add(1);
        }
    }
}

impl Row {
    /// Replaces the grey of the pixel in column `x` by a function of it. Only the low four bits of
    /// the result count. The function is not called for a pixel outside the row.
    pub fn update(&mut self, x: i32, new: impl FnOnce(u8) -> u8) {
        if let Some(pair) = self.0.get_mut((x >> 1) as usize) {
            let old = (*pair >> shift(x)) & 0x0F;
            *pair ^= (old ^ (new(old) & 0x0F)) << shift(x);
        }
    }

    /// Sets a pixel to a grey of 0 to 15. A pixel that is brighter already keeps its grey.
    pub fn lighten(&mut self, x: i32, grey: u8) {
        self.update(x, |old| old.max(grey));
    }
}

/// The speed of fading. Every row loses one grey in 64/`rows` ticks of the scene; with 0 rows
/// nothing fades.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fading {
    /// The number of rows that lose a grey in a tick. Above 64, some rows lose more than one.
    pub rows: u8,
    /// The final grey of a faded pixel, 0 to 15. Darker pixels do not change. From 15 on, nothing
    /// fades.
    pub last: u8,
}

impl Fading {
    /// The traces stay as they are.
    pub const NEVER: Self = Self { rows: 0, last: 15 };
    /// The fading of a trace that remains visible. It loses a grey in about a second, down to grey
    /// 4.
    pub const TRACE: Self = Self { rows: 1, last: 4 };
}

/// The traces of earlier frames. Each frame is drawn over them.
#[derive(Clone, Debug)]
pub struct FadeLayer {
    /// The traces. Each tick of the scene may add to them.
    pub frame: Canvas,
    /// The next row to fade.
    row: i32,
}

impl FadeLayer {
    /// A layer without traces. The first row to fade is the top one.
    pub const NONE: Self = Self {
        frame: Canvas::BLACK,
        row: 0,
    };

    /// Fades the next `rows` rows by one grey each, after the lowest row the top one again; to be
    /// called once a tick of the scene. Pixels at or below the grey `last` are unchanged.
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn fade(&mut self, Fading { rows, last }: Fading) {
        let room = u32::from(15_u8.saturating_sub(last)) * ONES;

        // A grey above `last` carries out of its nibble, and then loses 1.
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

/// The number 1 in every other nibble.
const ONES: u32 = 0x0101_0101;

/// Returns the carries of the greys in the low nibbles of the four bytes of `greys`: bit 0 of a
/// byte is 1 if the grey plus the summand in the same byte of `room`, 0 to 15, is at least 16. All
/// other bits are 0. The high nibbles are ignored.
pub(super) fn carried(greys: u32, room: u32) -> u32 {
    (((greys & (15 * ONES)) + room) >> 4) & ONES
}

/// Returns the position of a pixel's nibble in its byte, as a shift.
fn shift(x: i32) -> u32 {
    4 * (!x as u32 & 1)
}

/// Returns each of eight bits as a nibble of 0 or 15.
fn nibbles(bits: u32) -> u32 {
    let fours = (bits | bits << 12) & 0x000F_000F;
    let twos = (fours | fours << 6) & 0x0303_0303;
    15 * ((twos | twos << 3) & 0x1111_1111)
}
