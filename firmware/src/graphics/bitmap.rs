//! The frame in one colour: for panels whose pixels are on or off.

use crate::graphics::{Canvas, HEIGHT, Row, WIDTH};

const ROWS: usize = 8;
pub const PAGES: usize = HEIGHT / ROWS;

/// Bayer's matrix: the order in which the pixels of a square of 4 x 4 are lit as it becomes brighter.
const ORDER: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// The grey, of 15, that a pixel must exceed to be lit: 2 to 7 by its place in the order.
///
/// Soft edges want one threshold, for of many they turn ragged; a fading trail wants many, to fade. Both are had with
/// all thresholds in the lower half: what is brighter is solid, and what is fainter thins out to single pixels.
///
/// In a picture all greys matter: there it is 0 to 14, which is Bayer's.
const fn threshold(order: u8, all_greys: bool) -> u8 {
    if all_greys { order * 15 / 16 } else { 2 + order * 6 / 16 }
}

/// One in every other nibble.
const ONES: u32 = 0x0101_0101;

/// For every fourth row what carries out of the nibble of a lit pixel when added: to the pixels with even numbers, and to those
/// with odd ones, which are the high and the low nibbles.
const fn room(all_greys: bool) -> [[u32; 2]; 4] {
    let mut room = [[0; 2]; 4];
    let mut place = 0;
    while place < 16 {
        let (y, x) = (place / 4, place % 4);
        room[y][x % 2] |= (15 - threshold(ORDER[y][x], all_greys) as u32) * (0x0001_0001 << (8 * (x / 2)));
        place += 1;
    }
    room
}

/// Of a drawing, and of a picture.
const ROOM: [[[u32; 2]; 4]; 2] = [room(false), room(true)];

/// 128 x 64 pixels, each on or off, in the layout of the panel: pages of eight rows from the top, in each a byte for
/// every column from the left, in that the lowest bit on top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    pub pages: [[u8; WIDTH]; PAGES],
}

impl Default for Bitmap {
    fn default() -> Self {
        Self { pages: [[0; WIDTH]; PAGES] }
    }
}

impl From<&Canvas> for Bitmap {
    fn from(canvas: &Canvas) -> Self {
        let mut bitmap = Self::default();
        let [drawing, picture] = &ROOM;
        let room = if canvas.all_greys { picture } else { drawing };
        for (page, rows) in bitmap.pages.iter_mut().zip(canvas.rows.as_chunks::<ROWS>().0) {
            for (word, columns) in page.as_chunks_mut::<8>().0.iter_mut().enumerate() {
                let mut lit = [0; 2];
                for ((y, Row(row)), room) in rows.iter().enumerate().zip(room.iter().cycle()) {
                    let greys = row.as_chunks().0.get(word).map_or(0, |bytes| u32::from_le_bytes(*bytes));
                    for ((lit, greys), room) in lit.iter_mut().zip([greys >> 4, greys]).zip(room) {
                        *lit |= ((((greys & (15 * ONES)) + room) >> 4) & ONES) << y;
                    }
                }
                let [even, odd] = lit.map(u32::to_le_bytes);
                *columns = [even[0], odd[0], even[1], odd[1], even[2], odd[2], even[3], odd[3]];
            }
        }
        bitmap
    }
}
