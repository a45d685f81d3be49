//! From metres to pixels: where a pendulum is on the frame, and how it looks.

use double_pendulum::Parameters;

use crate::config::{GREATEST_RADIUS, LEAST_RADIUS, PIVOT, REACH, ROD_HALF_WIDTH};
use crate::graphics::{Canvas, Disc, SUBPIXELS, Spot, Stroke};

/// Where both rods point: (sin, cos) of their angles from the downward vertical.
pub type RodDirections = [[f32; 2]; 2];

/// Brightness of a rod, of 255: between the trail and the bobs.
const ROD_BRIGHTNESS: u8 = 190;
/// The dark gap that sets a bob off from what lies behind it, subpixels.
const GAP: u8 = SUBPIXELS as u8;

/// Where on the frame a pendulum hangs, in pixels.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The pivot, right and down from the panel's top left corner.
    pub pivot: (f32, f32),
    /// How far both rods reach when stretched out.
    pub reach: f32,
}

impl Place {
    pub const WHOLE: Self = Self { pivot: PIVOT, reach: REACH };
    /// The left half below a line of text, and the right half: a circle of 25 pixels with room for a bob around it, and
    /// between the two for a line of text below.
    pub const HALVES: [Self; 2] =
        [Self { pivot: (29.5, 36.0), reach: 25.0 }, Self { pivot: (98.5, 36.0), reach: 25.0 }];
}

#[derive(Clone, Copy, Debug)]
pub struct View {
    pivot: (f32, f32),
    rods: [f32; 2],
    radii: [u8; 2],
}

impl View {
    /// Both rods stretched out reach `place.reach` pixels.
    ///
    /// The bobs are spheres of one material, so a radius goes with the cube root of the mass; the heavier bob has
    /// [`GREATEST_RADIUS`], in a smaller place less in proportion, and none less than [`LEAST_RADIUS`].
    pub fn new(parameters: &Parameters<f32>, place: Place) -> Self {
        let &Parameters { m1, m2, l1, l2, .. } = parameters;
        let greatest = GREATEST_RADIUS * place.reach / REACH;
        let radius = |mass: f32| {
            let pixels = greatest * libm::cbrtf(mass / m1.max(m2));
            (pixels.max(LEAST_RADIUS) * SUBPIXELS as f32) as u8
        };
        let scale = place.reach / (l1 + l2);
        Self { pivot: place.pivot, rods: [scale * l1, scale * l2], radii: [radius(m1), radius(m2)] }
    }

    /// The centres of bob 1 and bob 2, in pixels right and down from the panel's top left corner: a rod that points to
    /// (sin a, cos a) from the downward vertical leads that far right and down. Pixel i covers i to i + 1.
    pub fn bobs(&self, [[sin1, cos1], [sin2, cos2]]: RodDirections) -> [(f32, f32); 2] {
        let ((x, y), [rod1, rod2]) = (self.pivot, self.rods);
        let (x1, y1) = (x + rod1 * sin1, y + rod1 * cos1);
        [(x1, y1), (x1 + rod2 * sin2, y1 + rod2 * cos2)]
    }

    pub fn spots(&self, directions: RodDirections) -> [Spot; 2] {
        self.bobs(directions).map(|(x, y)| Spot::at(x, y))
    }

    /// The radii of bob 1 and bob 2, subpixels.
    pub fn radii(&self) -> [u8; 2] {
        self.radii
    }

    /// Draws pivot, rods and bobs, the bobs at the centres given and with a brightness of 0 to 255.
    pub fn draw(&self, canvas: &mut Canvas, [bob1, bob2]: [Spot; 2], brightness: u8) {
        let pivot = Spot::at(self.pivot.0, self.pivot.1);
        let half_width = (ROD_HALF_WIDTH * SUBPIXELS as f32) as u8;
        let rod_brightness = ROD_BRIGHTNESS.min(brightness);
        for (from, to) in [(pivot, bob1), (bob1, bob2)] {
            Stroke { from, to, radius: half_width }.lighten(canvas, rod_brightness);
        }
        Stroke { from: pivot, to: pivot, radius: 2 * half_width }.lighten(canvas, rod_brightness);
        for (centre, radius) in [bob1, bob2].into_iter().zip(self.radii) {
            Disc { centre, radius, gap: GAP }.draw(canvas, brightness);
        }
    }
}
