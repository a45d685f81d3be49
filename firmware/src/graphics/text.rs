//! Text on the frame.

use crate::graphics::{Canvas, Glyph, HEIGHT, WIDTH, glyph};

/// Grey of the text, of 15: below the motion's.
const GREY: u8 = 11;
/// Text keeps this far from the panel's edges, pixels; a character brings such a gap above and on its right.
const MARGIN: i32 = 1;
const RIGHT: i32 = WIDTH as i32 - 1 - MARGIN;

pub const LINE: i32 = 8;
pub const LOWEST: i32 = HEIGHT as i32 - MARGIN - LINE;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    TopLeft,
    TopRight,
    BottomLeft,
    BottomRight,
    /// Its first character's top left corner at (x, y).
    At(i32, i32),
    /// Its last character before column x, its top at row y.
    EndingAt(i32, i32),
    /// Centred, its top at row y.
    Middle(i32),
}

pub fn write(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    put(canvas, text, corner(anchor, text), GREY);
}

/// Writes a line of text that stands out: dark on a light ground.
pub fn write_marked(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    put_on(canvas, text, anchor, [0, GREY]);
}

/// Writes a line of text over a picture: white on black.
pub fn write_over(canvas: &mut Canvas, text: &str, anchor: Anchor) {
    put_on(canvas, text, anchor, [15, 0]);
}

fn put_on(canvas: &mut Canvas, text: &str, anchor: Anchor, [ink, ground]: [u8; 2]) {
    let width = width(text);
    let (left, top) = corner(anchor, text);
    for x in (-1..width).step_by(8) {
        let row = !(0xFF_u32 >> (width - x).min(8)) as u8;
        canvas.stamp(left + x, top, u64::from_be_bytes([row; LINE as usize]), ground);
    }
    put(canvas, text, (left, top), ink);
}

fn width(text: &str) -> i32 {
    text.chars().map(|character| glyph(character).width).sum()
}

fn corner(anchor: Anchor, text: &str) -> (i32, i32) {
    // The last character's gap may lie in the margin.
    let right = || RIGHT + 2 - width(text);
    match anchor {
        Anchor::TopLeft => (MARGIN, 0),
        Anchor::TopRight => (right(), 0),
        Anchor::BottomLeft => (MARGIN, LOWEST),
        Anchor::BottomRight => (right(), LOWEST),
        Anchor::At(x, y) => (x, y),
        Anchor::EndingAt(x, y) => (x - width(text), y),
        Anchor::Middle(y) => (WIDTH as i32 / 2 - (width(text) - 1) / 2, y),
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
    const ROWS: core::ops::Range<i32> = LINE + 2..LINE + 9;
    for y in ROWS {
        for x in RIGHT - 7..=RIGHT {
            let bar = matches!(RIGHT - x, 0..=1 | 4..=5) && y > ROWS.start;
            canvas.update(x, y, |_| if bar { GREY } else { 0 });
        }
    }
}
