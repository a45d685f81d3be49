//! From metres to pixels: where a pendulum is on the frame, and how it looks.

use double_pendulum::Parameters;

use crate::config::{GREATEST_RADIUS, LEAST_RADIUS, PIVOT, REACH, ROD_HALF_WIDTH};
use crate::graphics::{Canvas, Disc, FadeLayer, SUBPIXELS, Spot, Stroke};

/// Where both rods point: (sin, cos) of their angles from the downward vertical.
pub type RodDirections = [[f32; 2]; 2];

/// Brightness of a rod, of 255: between the trail and the bobs.
const ROD_BRIGHTNESS: u8 = 190;
/// The dark gap that sets a bob off from what lies behind it, subpixels.
const GAP: u8 = SUBPIXELS as u8;
/// Half the width of a trace that stays, subpixels.
pub const TRACE_HALF_WIDTH: u8 = 30;

/// Where on the frame a pendulum hangs, pixels right and down from the panel's top left corner, and how far both rods reach.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub pivot: (f32, f32),
    pub reach: f32,
}

impl Place {
    pub const WHOLE: Self = Self {
        pivot: PIVOT,
        reach: REACH,
    };
    /// The left half below a line of text, and the right half: a circle of 25 pixels with room for a bob around it, and
    /// between the two for a line of text below.
    pub const HALVES: [Self; 2] = [
        Self {
            pivot: (29.5, 36.0),
            reach: 25.0,
        },
        Self {
            pivot: (98.5, 36.0),
            reach: 25.0,
        },
    ];
}

/// A pendulum on the frame.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pivot: (f32, f32),
    rods: [f32; 2],
    /// Of bob 1 and bob 2, subpixels.
    pub radii: [u8; 2],
    /// Where bob 1 and bob 2 are drawn.
    spots: [Spot; 2],
}

impl View {
    /// The bobs are spheres of one material, so a radius goes with the cube root of the mass; the heavier bob has
    /// [`GREATEST_RADIUS`], in a smaller place less in proportion, and none less than [`LEAST_RADIUS`].
    pub fn new(parameters: &Parameters<f32>, place: Place, directions: RodDirections) -> Self {
        let &Parameters { m1, m2, l1, l2, .. } = parameters;
        let greatest = GREATEST_RADIUS * place.reach / REACH;
        let radius = |mass: f32| {
            let pixels = greatest * libm::cbrtf(mass / m1.max(m2));
            (pixels.max(LEAST_RADIUS) * SUBPIXELS as f32) as u8
        };
        let (scale, radii) = (place.reach / (l1 + l2), [radius(m1), radius(m2)]);
        let mut view = Self {
            pivot: place.pivot,
            rods: [scale * l1, scale * l2],
            radii,
            spots: Default::default(),
        };
        view.turn(directions);
        view
    }

    /// The centres of bob 1 and bob 2, in pixels right and down from the panel's top left corner: a rod that points to
    /// (sin a, cos a) from the downward vertical leads that far right and down. Pixel i covers i to i + 1.
    pub fn bobs(&self, [[sin1, cos1], [sin2, cos2]]: RodDirections) -> [(f32, f32); 2] {
        let ((x, y), [rod1, rod2]) = (self.pivot, self.rods);
        let (x1, y1) = (x + rod1 * sin1, y + rod1 * cos1);
        [(x1, y1), (x1 + rod2 * sin2, y1 + rod2 * cos2)]
    }

    pub fn turn(&mut self, directions: RodDirections) {
        self.spots = self.bobs(directions).map(|(x, y)| Spot::at(x, y));
    }

    /// Turns the rods; bob 2 leaves a stroke `2 * half_width` subpixels wide, with a brightness of 0 to 255.
    pub fn trace(
        &mut self,
        directions: RodDirections,
        ink: &mut FadeLayer,
        half_width: u8,
        brightness: u8,
    ) {
        let [_, from] = self.spots;
        self.turn(directions);
        let [_, to] = self.spots;
        Stroke {
            from,
            to,
            radius: half_width,
        }
        .lighten(&mut ink.frame, brightness);
    }

    /// Draws pivot, rods and bobs, these with a brightness of 0 to 255.
    pub fn draw(&self, canvas: &mut Canvas, brightness: u8) {
        let (pivot, [bob1, bob2]) = (Spot::at(self.pivot.0, self.pivot.1), self.spots);
        let half_width = (ROD_HALF_WIDTH * SUBPIXELS as f32) as u8;
        let rod_brightness = ROD_BRIGHTNESS.min(brightness);
        for (from, to) in [(pivot, bob1), (bob1, bob2)] {
            Stroke {
                from,
                to,
                radius: half_width,
            }
            .lighten(canvas, rod_brightness);
        }
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
                gap: GAP,
            }
            .draw(canvas, brightness);
        }
    }
}
