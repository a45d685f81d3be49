//! Soft-edged strokes and discs in integer arithmetic: what rods, bobs and traces are made of.

use core::ops::Range;

use crate::graphics::{Canvas, HEIGHT, WIDTH};

pub const SUBPIXELS: i32 = 1 << SHIFT;
const SHIFT: u32 = 6;
const HALF: i32 = SUBPIXELS / 2;

/// A place on the canvas in subpixels from its top left corner; pixel i covers 64 i to 64 i + 63.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spot {
    pub x: i16,
    pub y: i16,
}

impl Spot {
    /// The spot at (x, y) pixels, kept within one canvas size of the canvas, so that no sum below can overflow.
    pub fn at(x: f32, y: f32) -> Self {
        let subpixels = |pixels: f32, size: usize| {
            let size = size as i32 * SUBPIXELS;
            ((pixels * SUBPIXELS as f32) as i32).clamp(-size, 2 * size) as i16
        };
        Self {
            x: subpixels(x, WIDTH),
            y: subpixels(y, HEIGHT),
        }
    }
}

/// All points within `radius` subpixels of the line from `from` to `to`: a disc if both are one spot.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    pub from: Spot,
    pub to: Spot,
    pub radius: u8,
}

impl Stroke {
    /// Draws it with a brightness of 0 to 255; where the canvas is brighter already, it stays.
    #[inline(never)] // once in a program
    pub fn lighten(&self, canvas: &mut Canvas, brightness: u8) {
        let limit = i32::from(self.radius) + HALF;
        let line = Line::new(self.from, self.to, limit);
        let grey = shade(brightness);
        let columns = pixels([self.from.x, self.to.x], limit, WIDTH);
        let rows = pixels([self.from.y, self.to.y], limit, HEIGHT);
        let mut band = line.band(rows.start);
        for y in rows {
            let near = band.next();
            let columns = columns.start.max(near.start)..columns.end.min(near.end);
            let Some(row) = canvas.row_mut(y) else { return };
            let to = line.to(columns.start, y);
            let mut progress = dot(line.along, to);
            let mut across = line.along.0 * to.1 - line.along.1 * to.0;
            for x in columns {
                let covered = line.covered((x, y), progress, across);
                if covered > 0 {
                    row.lighten(x, grey(covered));
                }
                progress += line.along.0 * SUBPIXELS;
                across -= line.along.1 * SUBPIXELS;
            }
        }
    }
}

/// A disc of `radius` subpixels that a dark gap, as wide as `gap` says, sets off from what lies behind it.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    pub centre: Spot,
    pub radius: u8,
    pub gap: u8,
}

impl Disc {
    /// Draws it with a brightness of 0 to 255.
    pub fn draw(&self, canvas: &mut Canvas, brightness: u8) {
        let Spot {
            x: centre_x,
            y: centre_y,
        } = self.centre;
        let edge = i32::from(self.radius) + HALF;
        let (inner, outer) = ((edge - SUBPIXELS).max(0), edge + i32::from(self.gap));
        let wiped = (outer - SUBPIXELS).max(0);
        let wipe = |old: u8, distance: i32| {
            (((distance - wiped).max(0) as u32 * u32::from(old)) >> SHIFT) as u8
        };
        let grey = shade(brightness);
        let columns = pixels([centre_x; 2], outer, WIDTH);
        for y in pixels([centre_y; 2], outer, HEIGHT) {
            let Some(row) = canvas.row_mut(y) else { return };
            let dy = middle(y) - i32::from(centre_y);
            for x in columns.clone() {
                let dx = middle(x) - i32::from(centre_x);
                let squared = dx * dx + dy * dy;
                if squared < inner * inner {
                    row.update(x, |_| grey(SUBPIXELS));
                } else if squared < edge * edge {
                    let distance = root(squared, inner, edge);
                    row.update(x, |old| wipe(old, distance).max(grey(edge - distance)));
                } else if squared < outer * outer {
                    row.update(x, |old| {
                        if old == 0 {
                            0
                        } else {
                            wipe(old, root(squared, edge, outer))
                        }
                    });
                } else if dx > 0 {
                    break;
                }
            }
        }
    }
}

/// The pixels of `size` that anything within `limit` of the places between two can touch.
fn pixels([a, b]: [i16; 2], limit: i32, size: usize) -> Range<i32> {
    let first = (i32::from(a.min(b)) - limit) >> SHIFT;
    let last = (i32::from(a.max(b)) + limit) >> SHIFT;
    first.max(0)..(last + 1).min(size as i32)
}

fn middle(pixel: i32) -> i32 {
    pixel * SUBPIXELS + HALF
}

/// For a brightness of 0 to 255, the function from a pixel's coverage, of [`SUBPIXELS`], to its grey: the edge is a ramp one
/// pixel wide, which is what a straight edge of any direction covers to within a few percent.
#[inline(always)]
fn shade(brightness: u8) -> impl Fn(i32) -> u8 {
    /// The product that makes one grey: full brightness, 255 = 17 x 15, times full coverage is 15 of them.
    const GREY: u32 = 17 * SUBPIXELS as u32;
    let greys = (u32::from(brightness) << 16).div_ceil(GREY);
    move |covered| ((covered.clamp(0, SUBPIXELS) as u32 * greys + (1 << 15)) >> 16) as u8
}

/// A straight line between two spots, and what is within `limit` of it.
struct Line {
    from: Spot,
    along: (i32, i32),
    length_squared: i32,
    length: i32,
    /// Beyond it nothing is covered, within `whole` all of a pixel.
    limit: i32,
    whole: i32,
}

/// The pixels of each row, from one row down to the next, that can be near the line made infinitely long: on a slope they are
/// few.
struct Band {
    /// Where the line crosses the middle of the row, and how far it moves from row to row; parts of a subpixel.
    middle: i32,
    slope: i32,
    /// Half of the band's width along a row, subpixels.
    half: i32,
}

impl Band {
    /// Parts of a subpixel, as a shift.
    const PARTS: u32 = 10;

    fn next(&mut self) -> Range<i32> {
        let middle = (self.middle >> Self::PARTS) + HALF;
        self.middle = self.middle.wrapping_add(self.slope);
        (middle - self.half) >> SHIFT..(middle + self.half) >> SHIFT
    }
}

impl Line {
    fn new(from: Spot, to: Spot, limit: i32) -> Self {
        let along = (
            i32::from(to.x) - i32::from(from.x),
            i32::from(to.y) - i32::from(from.y),
        );
        let length_squared = dot(along, along);
        let length = length_squared.unsigned_abs().isqrt() as i32;
        Self {
            from,
            along,
            length_squared,
            length,
            limit,
            whole: (limit - SUBPIXELS).max(0),
        }
    }

    /// From the row `y` on. A line that is nearly level, or is but a spot, is near all pixels of its rows.
    fn band(&self, y: i32) -> Band {
        /// Subpixels that a band is wider than the line: of the divisions and the slope each is off by less than one.
        const ROUNDED: i32 = 4;
        let (dx, dy) = self.along;
        let over = |product: i32| product.checked_div(dy).unwrap_or_default();
        if dx.abs() >= 8 * dy.abs() {
            return Band {
                middle: 0,
                slope: 0,
                half: 2 * WIDTH as i32 * SUBPIXELS,
            };
        }
        Band {
            middle: (i32::from(self.from.x) + over(dx * (middle(y) - i32::from(self.from.y))))
                << Band::PARTS,
            slope: over(dx << (Band::PARTS + SHIFT)),
            half: over(self.limit * (self.length + 1)).abs() + ROUNDED,
        }
    }

    fn to(&self, x: i32, y: i32) -> (i32, i32) {
        (
            middle(x) - i32::from(self.from.x),
            middle(y) - i32::from(self.from.y),
        )
    }

    /// How many subpixels of the pixel at (x, y) are covered, whose middle is `progress` along the line from its start and `across`
    /// from it, each times the line's length: `limit`, which is more than all, where that is within `whole` of the line; none
    /// beyond `limit`. Only between the two it takes a division.
    ///
    /// Spots lie no farther from the canvas than its size, so differences are below 3 x 128 x 64 = 24,576 across and half that
    /// down, and sums of two products below 24,576^2 x 1.25 = 7.6e8: 31 bits hold them.
    #[inline(always)]
    fn covered(&self, (x, y): (i32, i32), progress: i32, across: i32) -> i32 {
        let &Self {
            along,
            length,
            limit,
            whole,
            ..
        } = self;
        if progress > 0 && progress < self.length_squared {
            return match across.abs() {
                across if across >= limit * length => 0,
                across if across < whole * length => limit,
                across => limit - across.checked_div(length).unwrap_or_default(),
            };
        }
        let (dx, dy) = self.to(x, y);
        let end = if progress <= 0 {
            (dx, dy)
        } else {
            (dx - along.0, dy - along.1)
        };
        match dot(end, end) {
            squared if squared >= limit * limit => 0,
            squared if squared < whole * whole => limit,
            squared => limit - root(squared, whole, limit),
        }
    }
}

/// The square root, rounded down, of what is no less than the square of `low` and less than that of `high`: what the chord
/// between them says is never more, and less by a few.
#[inline(always)]
fn root(square: i32, low: i32, high: i32) -> i32 {
    let mut root = low
        + (square - low * low)
            .checked_div(low + high)
            .unwrap_or_default();
    while (root + 1) * (root + 1) <= square {
        root += 1;
    }
    root
}

fn dot(a: (i32, i32), b: (i32, i32)) -> i32 {
    a.0 * b.0 + a.1 * b.1
}
