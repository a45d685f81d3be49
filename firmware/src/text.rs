//! Text on the picture.

use embedded_graphics::Drawable;
use embedded_graphics::geometry::Point;
use embedded_graphics::mono_font::iso_8859_7::FONT_5X8;
use embedded_graphics::mono_font::{MonoTextStyle, MonoTextStyleBuilder};
use embedded_graphics::pixelcolor::{Gray4, GrayColor};
use embedded_graphics::text::{Alignment, Baseline, Text, TextStyleBuilder};

use crate::canvas::{Canvas, HEIGHT, WIDTH};

/// Grey of the text, of 15.
const GREY: Gray4 = Gray4::new(9);
const RIGHT: i32 = WIDTH as i32 - 1;
const BOTTOM: i32 = HEIGHT as i32 - 1;

/// Height of a line, pixels.
pub const LINE: i32 = 8;
/// Width of a character, pixels.
pub const CHARACTER: i32 = 5;

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
    put(canvas, text, anchor, MonoTextStyle::new(&FONT_5X8, GREY));
}

/// Writes a line of text that stands out: dark on a light ground.
pub fn write_marked(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    let style = MonoTextStyleBuilder::new().font(&FONT_5X8).text_color(Gray4::BLACK).background_color(GREY);
    put(canvas, text, anchor, style.build());
}

fn put(canvas: &mut Canvas, text: &str, anchor: Anchor, character: MonoTextStyle<Gray4>) {
    let (point, alignment, baseline) = match anchor {
        Anchor::TopLeft => (Point::new(0, 0), Alignment::Left, Baseline::Top),
        Anchor::TopRight => (Point::new(RIGHT, 0), Alignment::Right, Baseline::Top),
        Anchor::BottomLeft => (Point::new(0, BOTTOM), Alignment::Left, Baseline::Bottom),
        Anchor::BottomRight => (Point::new(RIGHT, BOTTOM), Alignment::Right, Baseline::Bottom),
        Anchor::At(x, y) => (Point::new(x, y), Alignment::Left, Baseline::Top),
        Anchor::Centred(x, y) => (Point::new(x, y), Alignment::Center, Baseline::Top),
    };
    let style = TextStyleBuilder::new().alignment(alignment).baseline(baseline).build();
    let Ok(_) = Text::with_text_style(text, point, character, style).draw(canvas);
}

/// Draws two upright bars below the top right corner: time stands still.
pub fn pause_mark(canvas: &mut Canvas) {
    const ROWS: core::ops::Range<i32> = LINE + 2..LINE + 9;
    for y in ROWS {
        for x in RIGHT - 7..=RIGHT {
            let bar = matches!(RIGHT - x, 0..=1 | 4..=5) && y > ROWS.start;
            canvas.update(x, y, |_| if bar { GREY.luma() } else { 0 });
        }
    }
}
