//! Soft-edged strokes in integer arithmetic: the one shape that rods, bobs and trail are all made of.

use core::ops::Range;

use crate::graphics::canvas::{Canvas, HEIGHT, WIDTH};

/// Subpixels in a pixel.
pub const SUBPIXELS: i32 = 64;
const HALF: i32 = SUBPIXELS / 2;

/// A place on the canvas in subpixels from its top left corner; pixel i covers 64 i to 64 i + 63.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spot {
    /// To the right.
    pub x: i16,
    /// Down.
    pub y: i16,
}

impl Spot {
    /// The spot at (x, y) pixels, held within one canvas of the canvas so that no sum below can overflow.
    pub fn at(x: f32, y: f32) -> Self {
        let subpixels = |pixels: f32, size: usize| {
            let size = size as i32 * SUBPIXELS;
            ((pixels * SUBPIXELS as f32) as i32).clamp(-size, 2 * size) as i16
        };
        Self { x: subpixels(x, WIDTH), y: subpixels(y, HEIGHT) }
    }

    fn to(self, end: Spot) -> (i32, i32) {
        (i32::from(end.x) - i32::from(self.x), i32::from(end.y) - i32::from(self.y))
    }
}

/// All points within `radius` subpixels of the line from `from` to `to`: a disc if both are one spot.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// One end.
    pub from: Spot,
    /// The other end.
    pub to: Spot,
    /// Half the width, subpixels.
    pub radius: u8,
}

impl Stroke {
    /// A disc.
    pub fn disc(centre: Spot, radius: u8) -> Self {
        Self { from: centre, to: centre, radius }
    }

    /// Draws it with a brightness of 0 to 255; where the canvas is brighter already, it stays.
    pub fn lighten(&self, canvas: &mut Canvas, brightness: u8) {
        /// The product that makes one grey: full brightness, 255 = 17 x 15, times full coverage is 15 of them.
        const GREY: u32 = 17 * SUBPIXELS as u32;
        self.cover(|x, y, coverage| {
            let grey = ((u32::from(brightness) * coverage + GREY / 2) / GREY) as u8;
            canvas.update(x, y, |old| old.max(grey));
        });
    }

    /// Wipes it out to black.
    pub fn erase(&self, canvas: &mut Canvas) {
        self.cover(|x, y, coverage| {
            let left = SUBPIXELS as u32 - coverage;
            canvas.update(x, y, |old| (u32::from(old) * left / SUBPIXELS as u32) as u8);
        });
    }

    /// Calls `paint` with each pixel touched and how much of it is covered, of [`SUBPIXELS`]: the edge is a ramp one
    /// pixel wide, which is what a straight edge of any direction covers to within a few percent.
    fn cover(&self, mut paint: impl FnMut(i32, i32, u32)) {
        let outer = i32::from(self.radius) + HALF;
        let pixels = |a: i16, b: i16, size: usize| {
            let first = (i32::from(a.min(b)) - outer).div_euclid(SUBPIXELS).max(0);
            let last = (i32::from(a.max(b)) + outer).div_euclid(SUBPIXELS).min(size as i32 - 1);
            first..last + 1
        };
        let line = Line::new(self.from, self.to);
        let columns = pixels(self.from.x, self.to.x, WIDTH);
        for y in pixels(self.from.y, self.to.y, HEIGHT) {
            let near = line.columns(y * SUBPIXELS + HALF, outer);
            let columns = columns.start.max(near.start)..columns.end.min(near.end);
            let mut probe = line.probe(columns.start * SUBPIXELS + HALF, y * SUBPIXELS + HALF);
            for x in columns {
                if let Some(coverage) = line.coverage(&probe, outer) {
                    paint(x, y, coverage);
                }
                line.advance(&mut probe);
            }
        }
    }
}

/// A straight line between two spots.
struct Line {
    from: Spot,
    along: (i32, i32),
    length_squared: i32,
    length: i32,
}

/// A place as a line sees it.
struct Probe {
    /// From the line's start, subpixels.
    from: (i32, i32),
    /// Along the line and across it, each times the line's length.
    progress: i32,
    across: i32,
}

impl Line {
    fn new(from: Spot, to: Spot) -> Self {
        let along = from.to(to);
        let length_squared = dot(along, along);
        Self { from, along, length_squared, length: root(length_squared) }
    }

    /// The pixels of the row whose middle is at `y` that can be nearer than `limit`: those about as near the line
    /// made infinitely long. On a slope they are few.
    fn columns(&self, y: i32, limit: i32) -> Range<i32> {
        let (along, across) = (self.along.0 * (y - i32::from(self.from.y)), limit * (self.length + 1));
        let place = |product: i32| product.checked_div(self.along.1).map(|x| i32::from(self.from.x) + x - HALF);
        match (place(along - across), place(along + across)) {
            (Some(a), Some(b)) => (a.min(b) - 1).div_euclid(SUBPIXELS)..(a.max(b) + 1).div_euclid(SUBPIXELS) + 1,
            _ => 0..WIDTH as i32,
        }
    }

    fn probe(&self, x: i32, y: i32) -> Probe {
        let from = (x - i32::from(self.from.x), y - i32::from(self.from.y));
        Probe { from, progress: dot(self.along, from), across: self.along.0 * from.1 - self.along.1 * from.0 }
    }

    /// To the pixel on the right.
    #[inline]
    fn advance(&self, probe: &mut Probe) {
        probe.from.0 += SUBPIXELS;
        probe.progress += self.along.0 * SUBPIXELS;
        probe.across -= self.along.1 * SUBPIXELS;
    }

    /// How much of the pixel around a place is covered, of [`SUBPIXELS`]: all of it as far as a pixel inside of `limit`,
    /// from there to `limit` in proportion; `None` beyond. Only between the two it takes a root or a division.
    ///
    /// Spots lie within one canvas of the canvas, so differences are below 3 x 128 x 64 = 24,576 across and half that
    /// down, and sums of two products below 24,576^2 x 1.25 = 7.6e8: 31 bits hold them.
    #[inline]
    fn coverage(&self, probe: &Probe, limit: i32) -> Option<u32> {
        let whole = (limit - SUBPIXELS).max(0);
        let distance = if probe.progress > 0 && probe.progress < self.length_squared {
            match probe.across.abs() {
                across if across >= limit * self.length => return None,
                across if across < whole * self.length => 0,
                across => across / self.length.max(1),
            }
        } else {
            let (dx, dy) = probe.from;
            let end = if probe.progress <= 0 { (dx, dy) } else { (dx - self.along.0, dy - self.along.1) };
            match dot(end, end) {
                squared if squared >= limit * limit => return None,
                squared if squared < whole * whole => 0,
                squared => root(squared),
            }
        };
        Some((limit - distance).min(SUBPIXELS) as u32)
    }
}

/// The square root rounded down; 0 below 0.
fn root(square: i32) -> i32 {
    square.max(0).unsigned_abs().isqrt() as i32
}

fn dot(a: (i32, i32), b: (i32, i32)) -> i32 {
    a.0 * b.0 + a.1 * b.1
}
