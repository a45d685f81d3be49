//! The frame in one colour: for panels whose pixels are on or off.

use crate::graphics::canvas::{Canvas, HEIGHT, Row, WIDTH, carried};

const ROWS: usize = 8;
pub const PAGES: usize = HEIGHT / ROWS;

/// Bayer's matrix: the order in which the pixels of a square of 4 x 4 are lit as it becomes brighter.
const ORDER: [[u32; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// For every fourth row what [carries](carried) out of the nibble of a lit pixel: of those with even numbers, and of those with odd
/// ones, which are the high and the low nibbles.
///
/// The grey, of 15, that a pixel must exceed to be lit is 2 to 7 by its place in the order. Soft edges want one threshold, for of many
/// they turn ragged; a fading trail wants many, to fade. Both are had with all thresholds in the lower half: what is brighter is
/// solid, and what is fainter thins out to single pixels. In a picture all greys matter: there it is 0 to 14, which is Bayer's.
const fn room(all_greys: bool) -> [[u32; 2]; 4] {
    let mut room = [[0; 2]; 4];
    let mut place = 0;
    while place < 16 {
        let (y, x) = (place / 4, place % 4);
        let order = ORDER[y][x];
        let threshold = if all_greys {
            order * 15 / 16
        } else {
            2 + order * 6 / 16
        };
        room[y][x % 2] |= (15 - threshold) * (0x0001_0001 << (8 * (x / 2)));
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

impl Bitmap {
    pub const BLACK: Self = Self {
        pages: [[0; WIDTH]; PAGES],
    };
}

impl From<&Canvas> for Bitmap {
    fn from(canvas: &Canvas) -> Self {
        let mut bitmap = Self::BLACK;
        let [drawing, picture] = &ROOM;
        let room = if canvas.all_greys { picture } else { drawing };
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
                let [even, odd] = lit.map(u32::to_le_bytes);
                *columns = [
                    even[0], odd[0], even[1], odd[1], even[2], odd[2], even[3], odd[3],
                ];
            }
        }
        bitmap
    }
}
