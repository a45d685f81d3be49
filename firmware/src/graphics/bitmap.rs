//! The frame in one colour, for panels whose pixels are on or off.

use crate::graphics::canvas::{Canvas, carried};
use crate::graphics::{Format, Palette};

/// The width and the height of an OLED, pixels.
const WIDTH: usize = Format::OLED.width as usize;
const HEIGHT: usize = Format::OLED.height as usize;

/// The number of rows in a page.
const ROWS: usize = 8;
/// The number of pages of a frame, 8. A page is eight rows of pixels.
pub const PAGES: usize = HEIGHT / ROWS;

/// The Bayer matrix: the lighting order of the pixels of a square of 4 x 4 as it becomes brighter.
const ORDER: [[u32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Returns the summands that [carry](carried) out of the nibble of a pixel that is to be lit, one
/// in each byte, for each of four rows: those for the pixels in even columns, and those for the odd
/// ones.
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
        // A word has two squares of the matrix.
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
/// are off, and greys from 8 on are on; in a picture ([`Palette::Map`]) only 0 is always off and
/// only 15 always on. The greys in between are patterns of 4 x 4 pixels.
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

/// Converts the greys to dots, as described at [`Bitmap`]. A larger canvas is cut off.
impl From<&Canvas<'_>> for Bitmap {
    fn from(canvas: &Canvas<'_>) -> Self {
        let mut bitmap = Self::BLACK;
        let [drawing, picture] = &ROOM;
        let room = match canvas.palette {
            Palette::Map => picture,
            _ => drawing,
        };

        // Eight pixels are one word of a row, and eight bytes of a page.
        for (page, columns) in bitmap.pages.iter_mut().enumerate() {
            let mut lit = [[0; 2]; WIDTH / 8];
            for (y, [even, odd]) in (0..ROWS).zip(room.iter().cycle()) {
                let [_, greys] = canvas.row(ROWS * page + y);
                for (lit, greys) in lit.iter_mut().zip(greys) {
                    // Most words are black.
                    if *greys == 0 {
                        continue;
                    }
                    lit[0] |= carried(greys >> 4, *even) << y;
                    lit[1] |= carried(*greys, *odd) << y;
                }
            }
            for (columns, lit) in columns.as_chunks_mut::<8>().0.iter_mut().zip(lit) {
                let [even, odd] = lit.map(u32::to_le_bytes);
                *columns = [
                    even[0], odd[0], even[1], odd[1], even[2], odd[2], even[3], odd[3],
                ];
            }
        }

        bitmap
    }
}
