//! Text on the frame.

use embedded_graphics::geometry::Point;
use embedded_graphics::image::GetPixel;
use embedded_graphics::mono_font::MonoFont;
use embedded_graphics::mono_font::iso_8859_7::FONT_5X8;
use embedded_graphics::pixelcolor::BinaryColor;

use crate::graphics::canvas::{Canvas, HEIGHT, WIDTH};

/// Grey of the text, of 15.
const GREY: u8 = 9;
const RIGHT: i32 = WIDTH as i32 - 1;
const BOTTOM: i32 = HEIGHT as i32 - 1;

/// Height of a line, pixels.
pub const LINE: i32 = 8;
/// Width of a character, pixels.
pub const CHARACTER: i32 = 5;

/// Characters in a row of the font's frame.
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
    /// Its middle at column x, its top at row y.
    Centred(i32, i32),
}

/// Writes a line of text.
pub fn write(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    put(canvas, text, anchor, |canvas, x, y, is_ink| {
        if is_ink {
            canvas.update(x, y, |_| GREY);
        }
    });
}

/// Writes a line of text that stands out: dark on a light ground.
pub fn write_marked(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    put(canvas, text, anchor, |canvas, x, y, is_ink| canvas.update(x, y, |_| if is_ink { 0 } else { GREY }));
}

/// Calls `paint` for each pixel of the text's box, and says whether it belongs to a character. The font is
/// `embedded-graphics`'s, a frame with the characters in rows; this loop takes a third of the time of its own.
fn put(canvas: &mut Canvas, text: &str, anchor: Anchor, paint: impl Fn(&mut Canvas, i32, i32, bool)) {
    let reach = text.chars().count() as i32 * CHARACTER - 1;
    let (left, top) = match anchor {
        Anchor::TopLeft => (0, 0),
        Anchor::TopRight => (RIGHT - reach, 0),
        Anchor::BottomLeft => (0, BOTTOM - LINE + 1),
        Anchor::BottomRight => (RIGHT - reach, BOTTOM - LINE + 1),
        Anchor::At(x, y) => (x, y),
        Anchor::Centred(x, y) => (x - reach / 2, y),
    };
    let MonoFont { image, glyph_mapping, .. } = FONT_5X8;
    for (character, left) in text.chars().zip((left..).step_by(CHARACTER as usize)) {
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
    }
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
