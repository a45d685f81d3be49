//! Text on the canvas.
//!
//! The ASCII characters are from the font of 5 x 8 pixels of
//! [`embedded-graphics`](https://docs.rs/embedded-graphics) (test `canvas`). They are stored as
//! whole rows, which are drawn in a fifth of the time of single pixels.

use crate::graphics::{Canvas, Format};

/// The grey of the text, of 15. It is darker than the motion.
const GREY: u8 = 11;
/// The distance of text from the edges, units. A character contains such a gap above it and on its
/// right.
const MARGIN: i32 = 1;

/// The position of a line of text. The last number is y, the row of its top.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The line begins at the left edge.
    Left(i32),
    /// The line ends at the right edge.
    Right(i32),
    /// The line is centred on the canvas.
    Middle(i32),
    /// The first character begins at column x.
    At(i32, i32),
    /// The last character ends before column x.
    EndingAt(i32, i32),
}

/// Writes a line of text over the canvas. The pixels around the characters stay.
pub fn write(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    let width = width(text);
    let corner = corner(anchor, width, canvas.format);
    put(canvas, text, width, corner, GREY);
}

/// The greys of ink and background of a highlighted line: black on grey 11.
pub const MARKED: [u8; 2] = [0, GREY];
/// The greys of ink and background of a line over a picture.
pub const WHITE_ON_BLACK: [u8; 2] = [15, 0];

/// Writes a line of text on a background, which begins one column left of the text.
pub fn write_on(canvas: &mut Canvas, text: &str, anchor: Anchor, [ink, ground]: [u8; 2]) {
    let width = width(text);
    let unit = canvas.format.units(1);
    let (left, top) = corner(anchor, width, canvas.format);

    // The background begins one column left of the text.
    canvas.touch(
        left - unit..left + unit * width,
        top..top.saturating_add(canvas.format.line()),
    );
    for x in (-1..width).step_by(8) {
        let row = !(0xFF_u32 >> (width - x).min(8)) as u8;
        let rows = u64::from_be_bytes([row; 8]);
        canvas.stamp_touched(left + unit * x, top, rows, ground);
    }

    put(canvas, text, width, (left, top), ink);
}

/// Returns the width of a line of text, units.
fn width(text: &str) -> i32 {
    text.chars().map(|character| glyph(character).width).sum()
}

/// Returns the top left corner of a line of text of this width.
fn corner(anchor: Anchor, width: i32, format: Format) -> (i32, i32) {
    let units = |units| format.units(units);
    match anchor {
        Anchor::Left(y) => (units(MARGIN), y),
        // The gap after the last character may be in the margin.
        Anchor::Right(y) => (format.right() - units(width), y),
        Anchor::Middle(y) => (format.right() / 2 - units((width - 1) / 2), y),
        Anchor::At(x, y) => (x, y),
        Anchor::EndingAt(x, y) => (x - units(width), y),
    }
}

/// Draws the characters from the corner (left, top) on.
fn put(canvas: &mut Canvas, text: &str, width: i32, (mut left, top): (i32, i32), grey: u8) {
    let end = left + canvas.format.units(width);
    canvas.touch(left..end, top..top.saturating_add(canvas.format.line()));
    for Glyph { width, rows } in text.chars().map(glyph) {
        canvas.stamp_touched(left, top, rows, grey);
        left += canvas.format.units(width);
    }
}

/// Draws the mark of a paused scene at the right edge: two upright bars.
pub fn pause_mark(canvas: &mut Canvas) {
    let left = canvas.format.right() - canvas.format.units(9);
    let top = canvas.format.line() + canvas.format.units(2);
    for (bits, grey) in [(0xFFFF_FFFF_FFFF_FF00, 0), (0x0033_3333_3333_3300, GREY)] {
        canvas.stamp(left, top, bits, grey);
    }
}

/// The picture of a character.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Glyph {
    /// The number of columns, with the gap after the character.
    pub width: i32,
    /// Eight rows from the top. The first row is in the highest byte, and the leftmost pixel of a
    /// row is in its highest bit. A bit of 1 is ink.
    pub rows: u64,
}

/// The glyphs of the file `font.pbm`, a picture with cells of 8 x 8 pixels, 8 in a row.
///
/// The ASCII characters from ' ' on come first. They are followed by characters that the font
/// lacks, draws illegibly or makes too wide.
const GLYPHS: [u64; 112] = {
    let font = include_bytes!("font.pbm");
    let mut glyphs = [0; 112];
    let mut pixel = 0;
    while pixel < 64 * 112 {
        let x = pixel % 64;
        let y = pixel / 64;
        // Counted from the end of the file. Each row has an end of line.
        let is_ink = font[font.len() - 65 * (112 - y) + x] == b'1';
        let glyph = &mut glyphs[8 * (y / 8) + x / 8];
        *glyph = *glyph << 1 | is_ink as u64;
        pixel += 1;
    }
    glyphs
};

/// Returns the glyph of a character; that of a question mark if the font lacks it.
#[inline]
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
