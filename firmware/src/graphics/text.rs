//! Text on the frame. The characters of ASCII are [`embedded-graphics`](https://docs.rs/embedded-graphics)' font of 5 x 8 pixels (test
//! `canvas`), as whole rows, which are drawn in a fifth of the time of its pixels.

use crate::graphics::{Canvas, HEIGHT, WIDTH};

/// Grey of the text, of 15: below the motion's.
const GREY: u8 = 11;
/// Text keeps this far from the panel's edges, pixels; a character brings such a gap above and on its right.
const MARGIN: i32 = 1;
const RIGHT: i32 = WIDTH as i32 - 1 - MARGIN;

pub const LINE: i32 = 8;
pub const LOWEST: i32 = HEIGHT as i32 - MARGIN - LINE;

/// Where a line of text stands, its top at row y.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// At the left edge, at the right one, and between the two.
    Left(i32),
    Right(i32),
    Middle(i32),
    /// Its first character from column x on.
    At(i32, i32),
    /// Its last character before column x.
    EndingAt(i32, i32),
}

pub fn write(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    put(canvas, text, corner(anchor, text), GREY);
}

/// Ink and ground of a line that stands out, and of one over a picture.
pub const MARKED: [u8; 2] = [0, GREY];
pub const WHITE_ON_BLACK: [u8; 2] = [15, 0];

pub fn write_on(canvas: &mut Canvas, text: &str, anchor: Anchor, [ink, ground]: [u8; 2]) {
    let width = width(text);
    let (left, top) = corner(anchor, text);
    for x in (-1..width).step_by(8) {
        let row = !(0xFF_u32 >> (width - x).min(8)) as u8;
        canvas.stamp(
            left + x,
            top,
            u64::from_be_bytes([row; LINE as usize]),
            ground,
        );
    }
    put(canvas, text, (left, top), ink);
}

fn width(text: &str) -> i32 {
    text.chars().map(|character| glyph(character).width).sum()
}

fn corner(anchor: Anchor, text: &str) -> (i32, i32) {
    match anchor {
        Anchor::Left(y) => (MARGIN, y),
        // The last character's gap may lie in the margin.
        Anchor::Right(y) => (RIGHT + 2 - width(text), y),
        Anchor::Middle(y) => (WIDTH as i32 / 2 - (width(text) - 1) / 2, y),
        Anchor::At(x, y) => (x, y),
        Anchor::EndingAt(x, y) => (x - width(text), y),
    }
}

#[inline(never)]
fn put(canvas: &mut Canvas, text: &str, (mut left, top): (i32, i32), grey: u8) {
    for Glyph { width, rows } in text.chars().map(glyph) {
        canvas.stamp(left, top, rows, grey);
        left += width;
    }
}

/// Draws two upright bars below the top right corner: time stands still.
pub fn pause_mark(canvas: &mut Canvas) {
    for (bits, grey) in [(0xFFFF_FFFF_FFFF_FF00, 0), (0x0033_3333_3333_3300, GREY)] {
        canvas.stamp(RIGHT - 7, LINE + 2, bits, grey);
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Glyph {
    /// Columns with the gap after it.
    pub width: i32,
    /// Eight rows from the top, the first in the highest byte, in each the leftmost pixel in the highest bit.
    pub rows: u64,
}

/// A picture of glyphs, cells of 8 x 8 pixels, 8 in a row: those of ASCII from ' ' on, and then those that the font lacks, draws illegibly
/// or gives too much room.
const GLYPHS: [u64; 112] = {
    let (font, mut glyphs, mut pixel) = (include_bytes!("font.pbm"), [0; 112], 0);
    while pixel < 64 * 112 {
        let (x, y) = (pixel % 64, pixel / 64);
        // From the file's end, each row with its end of line.
        let is_ink = font[font.len() - 65 * (112 - y) + x] == b'1';
        let glyph = &mut glyphs[8 * (y / 8) + x / 8];
        *glyph = *glyph << 1 | is_ink as u64;
        pixel += 1;
    }
    glyphs
};

/// The glyph of a character; of one that there is not, that of a question mark.
pub fn glyph(character: char) -> Glyph {
    let (place, width) = match character {
        ' ' => (0, 3),
        '.' => (95, 3),
        '½' => (96, 9),
        '±' => (97, 5),
        '°' => (98, 5),
        'μ' => (99, 5),
        '₁' => (100, 4),
        '₂' => (101, 4),
        'α' => (102, 6),
        'ω' => (103, 6),
        '√' => (104, 6),
        '→' => (105, 6),
        '↑' => (106, 6),
        '!'..='~' => (character as usize - ' ' as usize, 5),
        _ => ('?' as usize - ' ' as usize, 5),
    };
    Glyph {
        width,
        rows: GLYPHS.get(place).copied().unwrap_or_default(),
    }
}
