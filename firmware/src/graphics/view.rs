//! The picture of a pendulum: the conversion from metres to pixels, and the sizes of its parts.

use double_pendulum::Parameters;

use crate::config::{GREATEST_RADIUS, LEAST_RADIUS, PIVOT, REACH, ROD_HALF_WIDTH};
use crate::graphics::{Canvas, Disc, FadeLayer, SUBPIXELS, Spot, Stroke};

/// The directions of both rods, rod 1 first: (sin, cos) of their angles, each from the downward
/// vertical and positive to the right. Not checked: the length of each direction is 1.
pub type RodDirections = [[f32; 2]; 2];

/// The brightness of a rod, of 255. It is between the trail's and the bobs'.
const ROD_BRIGHTNESS: u8 = 190;
/// The width of the dark gap between a bob and its background, subpixels.
const GAP: u8 = SUBPIXELS as u8;
/// Half the width of a trace that fades as [`Fading::TRACE`](crate::graphics::Fading::TRACE) and so
/// remains visible, subpixels.
pub const TRACE_HALF_WIDTH: u8 = 30;

/// The place of a pendulum on the frame.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The pivot, pixels right and down from the top left corner of the canvas.
    pub pivot: (f32, f32),
    /// The length of both rods together, pixels.
    pub reach: f32,
}

impl Place {
    /// The whole frame, with the pivot in the middle and a reach of 28.5 pixels.
    pub const WHOLE: Self = Self {
        pivot: PIVOT,
        reach: REACH,
    };
    /// The left half and the right half. Each is a circle with a radius of 25 pixels and room for a
    /// bob around it. There is room for a line of text above them, and for one between them at the
    /// bottom. The pivots are at (29.5, 36) and (98.5, 36) pixels.
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

/// A pendulum on the frame: its sizes, and the present positions of its bobs.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pivot: (f32, f32),
    /// The lengths of rod 1 and rod 2, pixels.
    rods: [f32; 2],
    /// The radii of bob 1 and bob 2, subpixels.
    pub radii: [u8; 2],
    /// The positions of bob 1 and bob 2 on the canvas.
    spots: [Spot; 2],
}

impl View {
    /// Creates the view of a pendulum with these parameters and directions. Both rods together are
    /// `place.reach` pixels long. Nothing is checked. Of masses and lengths only the ratios count,
    /// and gravity has no effect. Positions are limited as in [`Spot::at`].
    ///
    /// The bobs are spheres of one material, so that their radii are proportional to the cube root
    /// of the mass. The heavier bob has the radius [`GREATEST_RADIUS`], 3 pixels in
    /// [`Place::WHOLE`], in proportion to the reach. No radius is less than [`LEAST_RADIUS`], 1.5
    /// pixels, or more than 255 subpixels. A ratio of masses that is NaN gives the least radius,
    /// and a rod length that is NaN the positions of [`turn`](Self::turn) for NaN.
    pub fn new(parameters: &Parameters<f32>, place: Place, directions: RodDirections) -> Self {
        let &Parameters { m1, m2, l1, l2, .. } = parameters;
        let greatest = GREATEST_RADIUS * place.reach / REACH;
        let radius = |mass: f32| {
            let pixels = greatest * libm::cbrtf(mass / m1.max(m2));
            (pixels.max(LEAST_RADIUS) * SUBPIXELS as f32) as u8
        };
        let scale = place.reach / (l1 + l2);
        let radii = [radius(m1), radius(m2)];
        let mut view = Self {
            pivot: place.pivot,
            rods: [scale * l1, scale * l2],
            radii,
            spots: Default::default(),
        };
        view.turn(directions);
        view
    }

    /// Returns the centres that bob 1 and bob 2 have with these directions, in pixels right and
    /// down from the top left corner of the canvas. The view is not turned. Unlike in
    /// [`turn`](Self::turn), the numbers are not limited, and may be NaN.
    ///
    /// A rod with the direction (sin a, cos a) from the downward vertical extends that far right
    /// and down. Pixel i covers i to i + 1.
    pub fn bobs(&self, [[sin1, cos1], [sin2, cos2]]: RodDirections) -> [(f32, f32); 2] {
        let ((x, y), [rod1, rod2]) = (self.pivot, self.rods);
        let x1 = x + rod1 * sin1;
        let y1 = y + rod1 * cos1;
        [(x1, y1), (x1 + rod2 * sin2, y1 + rod2 * cos2)]
    }

    /// Turns the rods to these directions: the bobs move there at once, and leave no trace. Their
    /// positions are limited as in [`Spot::at`]. A coordinate that is NaN becomes 0, the left or
    /// the top edge of the canvas.
    pub fn turn(&mut self, directions: RodDirections) {
        self.spots = self.bobs(directions).map(|(x, y)| Spot::at(x, y));
    }

    /// Turns the rods to these directions. Bob 2 leaves a straight stroke in the ink, from its last
    /// position to the new one, `2 * half_width` subpixels wide, with a brightness of 0 (black) to
    /// 255 (grey 15). Pixels that are brighter already keep their grey.
    ///
    /// The last position is the result of the last call of this function or of
    /// [`turn`](Self::turn). Before the first call it is the position that the view was created
    /// with. The parts of a stroke outside the canvas are not drawn.
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

    /// Draws the pivot, the rods and the bobs over the canvas. The brightness of the bobs is 0
    /// (black) to 255 (grey 15); the rods are no brighter than the bobs, and at most 190. Around
    /// each bob the background is darkened. Pixels under pivot and rods that are brighter already
    /// keep their grey; the bobs replace them. The parts outside the canvas are not drawn.
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
                gap: GAP,
            }
            .draw(canvas, brightness);
        }
    }
}
