//! Curves over time or another quantity. They have one value per column, and are drawn with soft
//! edges in integer arithmetic. Rows and columns are in pixels from the top left corner of the
//! canvas; pixels outside the canvas are ignored.

use crate::graphics::{Canvas, SUBPIXELS};

/// Half the thickness of a curve, subpixels of a unit.
const HALF_THICKNESS: i32 = 19;

/// A height on the canvas: subpixels of 1/32 pixel down from the top edge, negative above it.
pub type Height = i16;

/// Returns the height of `value`, subpixels down from the top edge, where the value 0 is `zero`
/// pixels below the top edge and a unit is `scale` pixels upwards. It is rounded towards 0, and
/// limited to the range of [`Height`], 1,024 pixels either way. If a number is NaN, or infinite ones
/// combine to NaN, the result is 0, the top edge.
pub const fn height(value: f32, zero: f32, scale: f32) -> Height {
    ((zero - scale * value) * SUBPIXELS as f32) as Height
}

/// Draws the part of a curve in column `x`, between two heights, subpixels, in either order. The
/// curve extends 19 subpixels of a unit above and below them. Its brightness is 0 (black) to 255 (grey 15).
/// Pixels that are brighter already keep their grey.
pub fn column(canvas: &mut Canvas, x: i32, from: Height, to: Height, brightness: u8) {
    /// The product of brightness and coverage that is one grey, as for a
    /// [`Stroke`](crate::graphics::Stroke): 255 = 17 x 15.
    const GREY: u16 = 17 * SUBPIXELS as u16;
    let half_thickness = canvas.format.units(HALF_THICKNESS);
    let top = i32::from(from.min(to)) - half_thickness;
    let bottom = i32::from(from.max(to)) + half_thickness;
    let first = top.div_euclid(SUBPIXELS).max(0);
    let last = bottom.div_euclid(SUBPIXELS).min(canvas.format.bottom() - 1);

    canvas.lighten_down(x, first..last + 1, |y| {
        let covered = bottom.min((y + 1) * SUBPIXELS) - top.max(y * SUBPIXELS);
        ((u16::from(brightness) * covered as u16 + GREY / 2) / GREY) as u8
    });
}

/// The grey of axes and scale lines, of 15. It is bright enough for a panel of one colour.
pub const AXIS_GREY: u8 = 8;

/// Draws a dotted line in row `y`, a unit of every third from column `from` to column `to`
/// (exclusive), in [`AXIS_GREY`]. Brighter pixels keep their grey.
pub fn axis(canvas: &mut Canvas, from: i32, to: i32, y: i32) {
    let unit = canvas.format.units(1);
    let touched = canvas.cells_of(from..to);
    for y in y..y + unit {
        if let Some(mut row) = canvas.row_in(y, touched) {
            let mut dot = from;
            while dot < to {
                (dot..dot + unit).for_each(|x| row.lighten(x, AXIS_GREY));
                dot += distance(unit);
            }
        }
    }
}

/// Returns the distance of the dots of a dotted line.
fn distance(unit: i32) -> i32 {
    3 * unit.max(1)
}

/// Draws a dotted line in column `x`, as [`axis`] does, from row `from` to row `to` (exclusive).
pub fn upright_axis(canvas: &mut Canvas, x: i32, from: i32, to: i32) {
    let unit = canvas.format.units(1);
    let mut dot = from;
    while dot < to {
        canvas.lighten(x..x + unit, dot..dot + unit, AXIS_GREY);
        dot += distance(unit);
    }
}

/// Draws a scale bar of one unit, upright or level, from (x1, y1) to (x2, y2), which is to its
/// right or below it, in [`AXIS_GREY`]. Either end has a foot of a unit to both sides. Brighter
/// pixels keep their grey.
pub fn bar(canvas: &mut Canvas, (x1, y1): (i32, i32), (x2, y2): (i32, i32)) {
    let unit = canvas.format.units(1);
    canvas.lighten(x1..x2 + unit, y1..y2 + unit, AXIS_GREY);
    let (across, down) = if x1 == x2 { (unit, 0) } else { (0, unit) };
    for (x, y) in [(x1, y1), (x2, y2)] {
        let columns = x - across..x + across + unit;
        let rows = y - down..y + down + unit;
        canvas.lighten(columns, rows, AXIS_GREY);
    }
}

/// Returns the smallest step of a scale that is at least `least`: 1, 2 or 5 times a power of ten,
/// from 0.01 to 100. Above 100 and for NaN, the result is 100; for 0 and negative numbers it is
/// 0.01.
pub fn scale_step(least: f32) -> f32 {
    const STEPS: [f32; 12] = [
        0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0,
    ];
    STEPS
        .into_iter()
        .find(|step| *step >= least)
        .unwrap_or(100.0)
}
