//! The frame in one colour, for panels whose pixels are on or off.

use crate::graphics::canvas::{Canvas, HEIGHT, Row, WIDTH, carried};

/// The number of rows in a page.
const ROWS: usize = 8;
/// The number of pages of a frame, 8. A page is eight rows of pixels.
pub const PAGES: usize = HEIGHT / ROWS;

/// The Bayer matrix: the lighting order of the pixels of a square of 4 x 4 as it becomes brighter.
const ORDER: [[u32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Returns the summands that [carry](carried) out of the nibble of a pixel that is to be lit, for
/// each of four rows: first for the pixels with even numbers, which are the high nibbles, then for
/// the pixels with odd numbers, which are the low nibbles.
///
/// A pixel is lit if its grey, of 15, exceeds a threshold of 2 to 7 that depends on its place in
/// the order. Soft edges need one threshold, because many make them ragged. A fading trail needs
/// many, in order to fade. Thresholds in the lower half satisfy both: brighter greys are solid, and
/// fainter ones thin out to single pixels.
///
/// In a picture all greys matter. There the thresholds are 0 to 14, as Bayer's.
const fn room(all_greys: bool) -> [[u32; 2]; 4] {
    let mut room = [[0; 2]; 4];
    let mut place = 0;
    while place < 16 {
        let y = place / 4;
        let x = place % 4;
        let order = ORDER[y][x];

        let threshold = if all_greys {
            order * 15 / 16
        } else {
            2 + order * 6 / 16
        };

        // The place of the summand is the nibble of this pixel's byte.
        room[y][x % 2] |= (15 - threshold) * (0x0001_0001 << (8 * (x / 2)));
        place += 1;
    }
    room
}

/// The summands for a drawing, and those for a picture.
const ROOM: [[[u32; 2]; 4]; 2] = [room(false), room(true)];

/// 128 x 64 pixels, each on or off, in the memory layout of the panel.
///
/// A page is eight rows; the first page is at the top. A page has a byte for each column from the
/// left. The lowest bit of a byte is the top row. A bit of 1 is a pixel that is on.
///
/// `Bitmap::from(&canvas)` converts the greys of a [`Canvas`] to dots. In a drawing, greys up to 2
/// are off, and greys from 8 on are on; in a picture ([`Canvas::all_greys`]) only 0 is always off
/// and only 15 always on. The greys in between are patterns of 4 x 4 pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    /// The pages from the top.
    pub pages: [[u8; WIDTH]; PAGES],
}

impl Bitmap {
    /// The frame with all pixels off.
    pub const BLACK: Self = Self {
        pages: [[0; WIDTH]; PAGES],
    };
}

/// Converts the greys to dots, as described at [`Bitmap`].
impl From<&Canvas> for Bitmap {
    fn from(canvas: &Canvas) -> Self {
        let mut bitmap = Self::BLACK;
        let [drawing, picture] = &ROOM;
        let room = if canvas.all_greys { picture } else { drawing };

        // Eight pixels are one word of a row, and eight bytes of a page.
        for (page, rows) in bitmap
            .pages
            .iter_mut()
            .zip(canvas.rows.as_chunks::<ROWS>().0)
        {
            for (word, columns) in page.as_chunks_mut::<8>().0.iter_mut().enumerate() {
                let mut lit = [0; 2];
                for ((y, Row(row)), room) in rows.iter().enumerate().zip(room.iter().cycle()) {
                    let greys = row
                        .as_chunks()
                        .0
                        .get(word)
                        .map_or(0, |bytes| u32::from_le_bytes(*bytes));
                    for ((lit, greys), room) in lit.iter_mut().zip([greys >> 4, greys]).zip(room) {
                        *lit |= carried(greys, *room) << y;
                    }
                }

                // The pixels with even numbers come from the high nibbles.
                let [even, odd] = lit.map(u32::to_le_bytes);
                *columns = [
                    even[0], odd[0], even[1], odd[1], even[2], odd[2], even[3], odd[3],
                ];
            }
        }

        bitmap
    }
}
