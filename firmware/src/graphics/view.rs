//! The picture of a pendulum: the conversion from metres to pixels, and the sizes of its parts.

use double_pendulum::Parameters;

use crate::config::{GREATEST_RADIUS, LEAST_RADIUS, REACH, ROD_HALF_WIDTH};
use crate::graphics::{Canvas, Disc, Format, SUBPIXELS, Spot, Stroke};

/// The directions of both rods: (sin, cos) of their angles from the downward vertical, positive to
/// the right.
pub type RodDirections = [[f32; 2]; 2];

/// The brightness of a rod, between the trail's and the bobs'.
const ROD_BRIGHTNESS: u8 = 190;
/// The width of the black gap between a bob and its background, subpixels.
const GAP: u16 = SUBPIXELS as u16;
/// Half the width of a trace that remains visible, subpixels on an OLED.
pub const TRACE_HALF_WIDTH: u16 = 15;

/// The width of the longest label in a corner, `½px>15.5 s`, units.
const CORNER: i32 = 51;

/// The place of a pendulum on the frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The format of the frame.
    pub format: Format,
    /// The pivot, pixels from the top left corner of the canvas.
    pub pivot: (f32, f32),
    /// The length of both rods together, pixels.
    pub reach: f32,
}

impl Place {
    /// Returns the place in a circle around `pivot`, which the heavier bob and its soft edge just
    /// touch.
    pub fn within(radius: f32, pivot: (f32, f32), format: Format) -> Self {
        let reach = (radius - 0.5) * (REACH / (REACH + GREATEST_RADIUS));
        Self {
            format,
            pivot,
            reach,
        }
    }

    /// Returns the place in the middle of the whole frame. On a larger panel it leaves the corners
    /// to labels.
    pub fn whole(format: Format) -> Self {
        let width = format.right() as f32;
        let height = format.bottom() as f32;
        let pivot = (0.5 * width, 0.5 * height);
        if !format.is_large() {
            return Self {
                format,
                pivot,
                reach: REACH,
            };
        }

        // The nearest corner of a label.
        let across = (0.5 * width - format.units(CORNER) as f32).max(0.0);
        let down = 0.5 * height - format.units(9) as f32;
        let radius = libm::sqrtf(across * across + down * down);
        Self::within(radius.min(0.5 * height), pivot, format)
    }

    /// Returns the left half and the right half. They leave room for a line of text above, and on a
    /// larger panel for one below.
    pub fn halves(format: Format) -> [Self; 2] {
        let width = format.right() as f32;
        let height = format.bottom() as f32;
        if !format.is_large() {
            return [29.5, width - 29.5].map(|x| Self {
                format,
                pivot: (x, 36.0),
                reach: 25.0,
            });
        }
        let radius = (0.5 * height - format.units(9) as f32).min(0.25 * width - 1.0);
        [0.25, 0.75].map(|part| Self::within(radius, (part * width, 0.5 * height), format))
    }
}

/// A pendulum on the frame: its sizes, and the present positions of its bobs.
#[derive(Clone, Copy, Debug)]
pub struct View {
    place: Place,
    /// The pivot on the canvas.
    pivot: Spot,
    /// The factor for the widths of lines and gaps.
    scale: f32,
    /// The lengths of rod 1 and rod 2, pixels.
    rods: [f32; 2],
    /// Half the width of a rod, and the width of the gap around a bob, subpixels.
    half_width: u16,
    gap: u16,
    /// The radii of bob 1 and bob 2, subpixels.
    pub radii: [u16; 2],
    /// The positions of bob 1 and bob 2 on the canvas.
    spots: [Spot; 2],
}

impl View {
    /// Creates the view of a pendulum. Of masses and lengths only the ratios count.
    ///
    /// The bobs are spheres of one material: their radii are proportional to the cube root of the
    /// mass, but not less than [`LEAST_RADIUS`].
    pub fn new(parameters: &Parameters<f64>, place: Place, directions: RodDirections) -> Self {
        let Parameters { m1, m2, l1, l2, .. } = parameters.cast::<f32>();
        let greatest = GREATEST_RADIUS * place.reach / REACH;
        let scale = (place.reach / REACH).max(1.0);
        let radius = |mass: f32| {
            let pixels = greatest * libm::cbrtf(mass / m1.max(m2));
            (pixels.max(LEAST_RADIUS * scale) * SUBPIXELS as f32) as u16
        };
        let metre = place.reach / (l1 + l2);
        let radii = [radius(m1), radius(m2)];
        let (x, y) = place.pivot;
        let mut view = Self {
            place,
            pivot: Spot::at(x, y, place.format),
            scale,
            rods: [metre * l1, metre * l2],
            half_width: (scale * ROD_HALF_WIDTH * SUBPIXELS as f32) as u16,
            gap: (scale * f32::from(GAP)) as u16,
            radii,
            spots: Default::default(),
        };
        view.turn(directions);
        view
    }

    /// Returns the centres of both bobs for these directions, pixels from the top left corner of
    /// the canvas. The view is not turned, and the numbers are not limited to the canvas.
    pub fn bobs(&self, [[sin1, cos1], [sin2, cos2]]: RodDirections) -> [(f32, f32); 2] {
        let (x, y) = self.place.pivot;
        let [rod1, rod2] = self.rods;
        let x1 = x + rod1 * sin1;
        let y1 = y + rod1 * cos1;
        [(x1, y1), (x1 + rod2 * sin2, y1 + rod2 * cos2)]
    }

    /// Turns the rods to these directions, without a trace.
    pub fn turn(&mut self, directions: RodDirections) {
        let format = self.place.format;
        self.spots = self.bobs(directions).map(|(x, y)| Spot::at(x, y, format));
    }

    /// Turns the rods to these directions. Bob 2 leaves a straight stroke in the ink, from its last
    /// position, `2 * half_width` subpixels wide on an OLED.
    pub fn trace(
        &mut self,
        directions: RodDirections,
        ink: &mut Canvas,
        half_width: u16,
        brightness: u8,
    ) {
        let [_, from] = self.spots;
        self.turn(directions);
        let [_, to] = self.spots;

        Stroke {
            from,
            to,
            radius: (self.scale * f32::from(half_width)) as u16,
        }
        .lighten(ink, brightness);
    }

    /// Draws the pivot, the rods and the bobs over the canvas, each bob in a black gap.
    pub fn draw(&self, canvas: &mut Canvas, brightness: u8) {
        let &Self {
            pivot,
            half_width,
            gap,
            spots: [bob1, bob2],
            ..
        } = self;
        let rod_brightness = ROD_BRIGHTNESS.min(brightness);

        for (from, to) in [(pivot, bob1), (bob1, bob2)] {
            Stroke {
                from,
                to,
                radius: half_width,
            }
            .lighten(canvas, rod_brightness);
        }

        // The pivot is a disc.
        Stroke {
            from: pivot,
            to: pivot,
            radius: 2 * half_width,
        }
        .lighten(canvas, rod_brightness);

        for (centre, radius) in [bob1, bob2].into_iter().zip(self.radii) {
            Disc {
                centre,
                radius,
                gap,
            }
            .draw(canvas, brightness);
        }
    }
}
