//! Text on the frame.

use embedded_graphics::geometry::Point;
use embedded_graphics::image::GetPixel;
use embedded_graphics::mono_font::MonoFont;
use embedded_graphics::mono_font::iso_8859_7::FONT_5X8;
use embedded_graphics::pixelcolor::BinaryColor;

use crate::graphics::canvas::{Canvas, HEIGHT, WIDTH};

/// Grey of the text, of 15: below the motion's.
const GREY: u8 = 11;
/// Text keeps this far from the panel's edges, pixels; a character brings such a gap above and on its right.
const MARGIN: i32 = 1;
const RIGHT: i32 = WIDTH as i32 - 1 - MARGIN;

/// Height of a line, pixels.
pub const LINE: i32 = 8;
/// The top of the lowest line.
pub const LOWEST: i32 = HEIGHT as i32 - MARGIN - LINE;

/// Width of a character of the font, and characters in a row of its image.
const CHARACTER: i32 = 5;
const IN_A_ROW: usize = 16;

/// Where a text goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Into the top left corner.
    TopLeft,
    /// Into the top right corner.
    TopRight,
    /// Into the bottom left corner.
    BottomLeft,
    /// Into the bottom right corner.
    BottomRight,
    /// Its first character's top left corner at (x, y).
    At(i32, i32),
    /// Its last character before column x, its top at row y.
    EndingAt(i32, i32),
    /// Its middle at column x, its top at row y.
    Centred(i32, i32),
}

/// Writes a line of text.
pub fn write(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    put(canvas, text, anchor, GREY, None);
}

/// Writes a line of text that stands out: dark on a light ground.
pub fn write_marked(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    let (left, top) = corner(text, anchor);
    (top..top + LINE).for_each(|y| canvas.update(left - 1, y, |_| GREY));
    put(canvas, text, anchor, 0, Some(GREY));
}

/// Where the top left corner of a text goes.
fn corner(text: &str, anchor: Anchor) -> (i32, i32) {
    let width: i32 = text.chars().map(|character| own(character).map_or(CHARACTER, |(width, _)| width)).sum();
    // The last character's gap may lie in the margin.
    let right = RIGHT + 2 - width;
    match anchor {
        Anchor::TopLeft => (MARGIN, 0),
        Anchor::TopRight => (right, 0),
        Anchor::BottomLeft => (MARGIN, LOWEST),
        Anchor::BottomRight => (right, LOWEST),
        Anchor::At(x, y) => (x, y),
        Anchor::EndingAt(x, y) => (x - width, y),
        Anchor::Centred(x, y) => (x - (width - 1) / 2, y),
    }
}

/// Writes in the grey `ink` on the grey `ground` or on what is there. The font is `embedded-graphics`'s, an image with the
/// characters in rows; this loop takes a third of the time of its own.
#[inline(never)]
fn put(canvas: &mut Canvas, text: &str, anchor: Anchor, ink: u8, ground: Option<u8>) {
    let paint = |canvas: &mut Canvas, x: i32, y: i32, is_ink: bool| {
        if let Some(grey) = if is_ink { Some(ink) } else { ground } {
            canvas.update(x, y, |_| grey);
        }
    };
    let (mut left, top) = corner(text, anchor);
    for character in text.chars() {
        if let Some((width, rows)) = own(character) {
            for (y, row) in (top..).zip(rows) {
                (0..width).for_each(|x| paint(canvas, left + x, y, row >> (width - 1 - x) & 1 != 0));
            }
            left += width;
            continue;
        }
        let MonoFont { image, glyph_mapping, .. } = FONT_5X8;
        let index = match character {
            // The mapping searches; the font begins with these.
            ' '..='~' => character as usize - ' ' as usize,
            _ => glyph_mapping.index(character),
        };
        let (row, column) = (index / IN_A_ROW, index % IN_A_ROW);
        let glyph = Point::new(column as i32 * CHARACTER, row as i32 * LINE);
        for y in 0..LINE {
            for x in 0..CHARACTER {
                let is_ink = image.pixel(glyph + Point::new(x, y)) == Some(BinaryColor::On);
                paint(canvas, left + x, top + y, is_ink);
            }
        }
        left += CHARACTER;
    }
}

/// The characters that the font lacks, draws illegibly or gives too much room: width with the gap after it, and the rows
/// from the top, the leftmost pixel in the highest bit.
#[rustfmt::skip]
fn own(character: char) -> Option<(i32, [u16; LINE as usize])> {
    Some(match character {
        ' ' => (3, [0; 8]),
        '.' => (3, [0, 0, 0, 0, 0, 0b110, 0b110, 0]),
        '½' => (9, [
            0b0_0000_0000,
            0b0_1000_1000,
            0b1_1000_1000,
            0b0_1001_0000,
            0b0_1010_1100,
            0b0_0010_0010,
            0b0_0100_0100,
            0b0_0100_1110,
        ]),
        '₁' => (4, [0, 0, 0, 0b0100, 0b1100, 0b0100, 0b0100, 0b1110]),
        '₂' => (4, [0, 0, 0, 0b1100, 0b0010, 0b0100, 0b1000, 0b1110]),
        'α' => (6, [0, 0, 0, 0b011010, 0b100100, 0b100100, 0b011010, 0]),
        'ω' => (6, [0, 0, 0, 0b100010, 0b101010, 0b101010, 0b010100, 0]),
        '√' => (6, [0, 0b001110, 0b001000, 0b001000, 0b101000, 0b101000, 0b010000, 0]),
        '→' => (6, [0, 0, 0b001000, 0b000100, 0b111110, 0b000100, 0b001000, 0]),
        '↑' => (6, [0, 0b001000, 0b011100, 0b101010, 0b001000, 0b001000, 0b001000, 0]),
        _ => return None,
    })
}

/// Draws two upright bars below the top right corner: time stands still.
pub fn pause_mark(canvas: &mut Canvas) {
    const ROWS: core::ops::Range<i32> = LINE + 2..LINE + 9;
    for y in ROWS {
        for x in RIGHT - 7..=RIGHT {
            let bar = matches!(RIGHT - x, 0..=1 | 4..=5) && y > ROWS.start;
            canvas.update(x, y, |_| if bar { GREY } else { 0 });
        }
    }
}
