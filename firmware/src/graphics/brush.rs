//! Strokes and discs with soft edges, in integer arithmetic. Rods, bobs and traces are made of
//! them. Not checked: their spots are within the limits of [`Spot::at`], and their radii and gaps
//! are smaller than a canvas. Otherwise sums may overflow.

use core::ops::Range;

use crate::graphics::{Canvas, Format};

/// The number of subpixels in a pixel, 32 in each direction. With more, products of differences
/// would not fit into 31 bits on a canvas of 320 x 240.
pub const SUBPIXELS: i32 = 1 << SHIFT;
const SHIFT: u32 = 5;
const HALF: i32 = SUBPIXELS / 2;

/// A point on or near the canvas, in subpixels from its top left corner. Pixel i covers 32 i to
/// 32 i + 31.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spot {
    /// The distance to the right, subpixels; negative to the left of the canvas.
    pub x: i16,
    /// The distance down, subpixels; negative above the canvas.
    pub y: i16,
}

impl Spot {
    /// Returns the spot at (x, y) pixels, where (0, 0) is the top left corner of the canvas.
    ///
    /// Each coordinate is limited to one canvas size around the canvas, so that no sum in this
    /// module can overflow. It is rounded towards 0 to a subpixel. NaN becomes 0.
    pub fn at(x: f32, y: f32, format: Format) -> Self {
        let subpixels = |pixels: f32, size: i32| {
            let size = size * SUBPIXELS;
            ((pixels * SUBPIXELS as f32) as i32).clamp(-size, 2 * size) as i16
        };
        Self {
            x: subpixels(x, format.right()),
            y: subpixels(y, format.bottom()),
        }
    }
}

/// The points within `radius` subpixels of the line from `from` to `to`. If both ends are the same,
/// it is a disc. The edge is soft: over one pixel, half of it outside, the grey falls to 0. So a
/// stroke with a radius below 16 is fainter, and one with radius 0 has at most half the brightness.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// One end of the line.
    pub from: Spot,
    /// The other end.
    pub to: Spot,
    /// Half the width of the stroke, subpixels.
    pub radius: u16,
}

impl Stroke {
    /// Draws the stroke with a brightness of 0 (black) to 255 (grey 15). Pixels that are brighter
    /// already keep their grey. The parts outside the canvas are not drawn.
    #[inline(never)] // Test `scenes` profiles it by its name.
    pub fn lighten(&self, canvas: &mut Canvas, brightness: u8) {
        let limit = i32::from(self.radius) + HALF;
        let line = Line::new(self.from, self.to, limit, brightness);

        let format = canvas.format;
        let columns = pixels([self.from.x, self.to.x], limit, format.right());
        let rows = pixels([self.from.y, self.to.y], limit, format.bottom());

        // Each row is visited only where the line is near.
        let mut band = line.band(rows.start);
        for y in rows {
            let near = band.next();
            let columns = columns.start.max(near.start)..columns.end.min(near.end);
            let Some(mut row) = canvas.row_mut(y, columns.clone()) else {
                return;
            };

            // Both products are updated from pixel to pixel, because a sum costs less than a
            // product.
            let to = line.to(columns.start, y);
            let mut progress = dot(line.along, to);
            let mut across = line.along.0 * to.1 - line.along.1 * to.0;
            for x in columns {
                let grey = line.grey((x, y), progress, across);
                if grey > 0 {
                    row.lighten(x, grey);
                }
                progress += line.along.0 * SUBPIXELS;
                across -= line.along.1 * SUBPIXELS;
            }
        }
    }
}

/// A disc of `radius` subpixels, surrounded by a black gap of `gap` subpixels that separates it
/// from the background. The disc has a soft edge, one pixel wide, half of it outside the radius.
/// The gap has a hard edge. A disc with a radius below 16 is fainter.
#[derive(Clone, Copy, Debug)]
pub struct Disc {
    /// The middle.
    pub centre: Spot,
    /// The radius without the gap, subpixels.
    pub radius: u16,
    /// The width of the gap, subpixels.
    pub gap: u16,
}

impl Disc {
    /// Draws the disc over the canvas, with a brightness of 0 (black) to 255 (grey 15). Pixels
    /// whose middles are in the disc or its gap are replaced. In the rest of the soft edge, pixels
    /// that are brighter already keep their grey. The parts outside the canvas are not drawn.
    pub fn draw(&self, canvas: &mut Canvas, brightness: u8) {
        let centre = self.centre;
        let radius = i32::from(self.radius);
        let edge = radius + HALF;
        let wiped = radius + i32::from(self.gap);

        let soft = Edge::new(edge, |distance| distance * distance, brightness);
        let format = canvas.format;
        let outer = edge.max(wiped);
        let touched = canvas.cells_of(pixels([centre.x; 2], outer, format.right()));
        for y in pixels([centre.y; 2], outer, format.bottom()) {
            let Some(mut row) = canvas.row_in(y, touched) else {
                return;
            };
            let dy = middle(y) - i32::from(centre.y);
            // The columns whose middles are within `limit` of the centre.
            let columns = |limit: i32| {
                let square = limit * limit - dy * dy;
                if square < 0 {
                    return 0..0;
                }
                let half = square.unsigned_abs().isqrt() as i32;
                let first = i32::from(centre.x) - half + HALF - 1;
                let end = i32::from(centre.x) + half + HALF;
                (first >> SHIFT).max(0)..(end >> SHIFT).min(format.right())
            };

            row.fill(columns(wiped), 0);
            for x in columns(edge) {
                let dx = middle(x) - i32::from(centre.x);
                row.lighten(x, soft.grey(dx * dx + dy * dy));
            }
        }
    }
}

/// Returns the range of pixels, out of `size`, that can be touched by points within `limit` of the
/// range between two coordinates.
fn pixels([a, b]: [i16; 2], limit: i32, size: i32) -> Range<i32> {
    let first = (i32::from(a.min(b)) - limit) >> SHIFT;
    let last = (i32::from(a.max(b)) + limit) >> SHIFT;
    first.max(0)..(last + 1).min(size)
}

/// Returns the middle of a pixel, subpixels.
fn middle(pixel: i32) -> i32 {
    pixel * SUBPIXELS + HALF
}

/// A straight line between two spots, and its soft edge.
struct Line {
    from: Spot,
    along: (i32, i32),
    length_squared: i32,
    length: i32,
    /// The distance from the line beyond which nothing is covered, subpixels.
    limit: i32,
    /// The soft edge, for distances times `length`.
    edge: Edge,
}

/// The range of pixels of each row that can be near the line, if the line is extended without end.
/// Rows are visited downwards. On a steep line the ranges are short.
struct Band {
    /// The x coordinate of the line in the middle of the row, and its change from row to row, in
    /// 1/1024 subpixels.
    middle: i32,
    slope: i32,
    /// Half of the width of the band along a row, subpixels.
    half: i32,
}

impl Band {
    /// The fraction bits of `middle` and `slope`.
    const PARTS: u32 = 10;

    /// Returns the columns of the current row, and moves on to the next row. They may be outside
    /// the canvas.
    fn next(&mut self) -> Range<i32> {
        let middle = (self.middle >> Self::PARTS) + HALF;
        self.middle = self.middle.wrapping_add(self.slope);
        (middle - self.half) >> SHIFT..(middle + self.half) >> SHIFT
    }
}

impl Line {
    fn new(from: Spot, to: Spot, limit: i32, brightness: u8) -> Self {
        let along = (
            i32::from(to.x) - i32::from(from.x),
            i32::from(to.y) - i32::from(from.y),
        );
        let length_squared = dot(along, along);
        // A spot counts as a line of length 1, so that its distances have a measure.
        let length = (length_squared.unsigned_abs().isqrt() as i32).max(1);
        Self {
            from,
            along,
            length_squared,
            length,
            limit,
            edge: Edge::new(limit, |distance| distance * length, brightness),
        }
    }

    /// Returns the band from the row `y` on.
    ///
    /// A line that is nearly level, or only a spot, is near all pixels of its rows.
    fn band(&self, y: i32) -> Band {
        /// The excess width of a band, subpixels. The two divisions and the slope are each off by
        /// less than one subpixel.
        const ROUNDED: i32 = 4;
        let (dx, dy) = self.along;
        let over = |product: i32| product.checked_div(dy).unwrap_or_default();

        if dx.abs() >= 8 * dy.abs() {
            return Band {
                middle: 0,
                slope: 0,
                half: i32::from(i16::MAX),
            };
        }

        Band {
            middle: (i32::from(self.from.x) + over(dx * (middle(y) - i32::from(self.from.y))))
                << Band::PARTS,
            slope: over(dx << (Band::PARTS + SHIFT)),
            half: over(self.limit * (self.length + 1)).abs() + ROUNDED,
        }
    }

    /// Returns the vector from the start of the line to the middle of the pixel at (x, y),
    /// subpixels.
    fn to(&self, x: i32, y: i32) -> (i32, i32) {
        (
            middle(x) - i32::from(self.from.x),
            middle(y) - i32::from(self.from.y),
        )
    }

    /// Returns the grey of the pixel at (x, y).
    ///
    /// `progress` and `across` are the distances of the middle of the pixel along the line from its
    /// start and across it, each times the length of the line.
    ///
    /// A spot is at most one canvas size outside the canvas. So differences are at most 3 x 320 x 32
    /// = 30,720 across and 3 x 240 x 32 = 23,040 down, and the sum of their squares is 1.5e9. It
    /// fits into 31 bits.
    fn grey(&self, (x, y): (i32, i32), progress: i32, across: i32) -> u8 {
        // The pixel is next to the line: the distance across counts.
        if progress > 0 && progress < self.length_squared {
            return self.edge.grey(across.abs());
        }

        // The pixel is beyond an end: the distance from that end counts.
        let (dx, dy) = self.to(x, y);
        let end = if progress <= 0 {
            (dx, dy)
        } else {
            (dx - self.along.0, dy - self.along.1)
        };
        let square = dot(end, end);
        if square >= self.limit * self.limit {
            return 0;
        }
        self.edge
            .grey(square.unsigned_abs().isqrt() as i32 * self.length)
    }
}

/// A soft edge, one pixel wide, in which the grey falls linearly to 0.
///
/// The distance of a pixel is given by a measure that grows with it: its product with the length of
/// a line, or its square. So a pixel needs no division and mostly no root. With the product, the
/// edge agrees with the covered area to a few percent. With the square, it is brighter in the
/// middle, by 1.3 of 15 greys at a radius of 1.5 pixels.
#[derive(Clone, Copy)]
struct Edge {
    /// The measure at which the grey becomes 0.
    outer: i32,
    /// The width of the edge, in units of the measure.
    width: i32,
    /// The greys per unit of the measure, in 2^-`PARTS`.
    slope: i32,
}

impl Edge {
    /// The fraction bits of a grey. With more, the product of the brightness would not fit into 31
    /// bits.
    const PARTS: u32 = 23;

    /// Creates the edge whose grey is 0 at the distance `limit`, subpixels. One pixel further in it
    /// has the full `brightness`, 0 (black) to 255 (grey 15). It has less if `limit` is below one
    /// pixel.
    fn new(limit: i32, measure: impl Fn(i32) -> i32, brightness: u8) -> Self {
        /// The brightness of grey 1.
        const GREY: i32 = 17;
        let soft = limit.min(SUBPIXELS);
        let outer = measure(limit);
        // It is at least 16. `max` shows the compiler that the division cannot fail.
        let width = (outer - measure(limit - soft)).max(1);
        let greys = (i32::from(brightness) * soft) << (Self::PARTS - SHIFT);
        Self {
            outer,
            width,
            slope: greys / GREY / width,
        }
    }

    /// Returns the grey of a pixel.
    fn grey(self, measure: i32) -> u8 {
        let rest = self.outer - measure;
        if rest <= 0 {
            return 0;
        }
        let rest = rest.min(self.width);
        ((rest * self.slope + (1 << (Self::PARTS - 1))) >> Self::PARTS) as u8
    }
}

/// Returns the scalar product.
fn dot(a: (i32, i32), b: (i32, i32)) -> i32 {
    a.0 * b.0 + a.1 * b.1
}
