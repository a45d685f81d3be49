//! The frame in one colour: for panels whose pixels are on or off.

use crate::graphics::canvas::{Canvas, HEIGHT, WIDTH};

/// Rows that share a byte.
const ROWS: usize = 8;
/// Pages of eight rows.
pub const PAGES: usize = HEIGHT / ROWS;

/// Bayer's matrix: the order in which the pixels of a square of 4 x 4 are lit as it becomes brighter.
const ORDER: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// The grey, of 15, that a pixel must exceed to be lit: 2 to 7 by its place in the order.
///
/// Soft edges want one threshold, for of many they turn ragged; a fading trail wants many, to fade. Both are had with
/// all thresholds in the lower half: what is brighter is solid, and what is fainter thins out to single pixels.
fn threshold(order: u8) -> u8 {
    2 + order * 6 / 16
}

/// 128 x 64 pixels, each on or off, in the layout of the panel: pages of eight rows from the top, in each a byte for
/// every column from the left, in that the lowest bit on top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    pages: [[u8; WIDTH]; PAGES],
}

impl Default for Bitmap {
    /// All dark.
    fn default() -> Self {
        Self { pages: [[0; WIDTH]; PAGES] }
    }
}

impl From<&Canvas> for Bitmap {
    fn from(canvas: &Canvas) -> Self {
        let mut bitmap = Self::default();
        let rows = canvas.bytes().as_chunks::<{ WIDTH / 2 }>().0.iter().zip(ORDER.iter().cycle());
        for (y, (row, order)) in rows.enumerate() {
            let greys = row.iter().flat_map(|byte| [byte >> 4, byte & 0x0F]);
            let lit = greys.zip(order.iter().cycle()).map(|(grey, order)| grey > threshold(*order));
            if let Some(page) = bitmap.pages.get_mut(y / ROWS) {
                for (byte, lit) in page.iter_mut().zip(lit) {
                    *byte |= u8::from(lit) << (y % ROWS);
                }
            }
        }
        bitmap
    }
}

impl Bitmap {
    /// The pages from the top.
    pub fn pages(&self) -> &[[u8; WIDTH]; PAGES] {
        &self.pages
    }

    /// Whether the pixel is lit; `false` outside.
    pub fn is_lit(&self, x: usize, y: usize) -> bool {
        self.pages.get(y / ROWS).and_then(|page| page.get(x)).is_some_and(|byte| byte >> (y % ROWS) & 1 != 0)
    }
}
