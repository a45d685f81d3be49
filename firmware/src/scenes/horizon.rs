//! The honest clock: until when the frame of a motion is right to half a pixel.

use double_pendulum::{Error, Parameters, State};

use crate::config::{STEPS_PER_TICK, TICK_RATE};
use crate::graphics::canvas::Canvas;
use crate::graphics::label;
use crate::graphics::text::{self, Anchor};
use crate::motion::direction_stepper::{DirectionStepper, Directions};
use crate::scenes::scene::Report;

/// A place on the frame, pixels right and down.
type Place = (f32, f32);

/// A frame that is farther off than this, pixels, is not to be trusted.
pub const HALF_PIXEL: f32 = 0.5;

/// The twin may be half as far off: where both are as wrong, they may by chance be wrong in the same way.
const TWIN_LIMIT: f32 = 0.5 * HALF_PIXEL;

/// The twin's steps in a tick, where the motion shown makes four.
const TWIN_STEPS: u32 = 3;
const TWIN_STEP: f64 = 1.0 / (TICK_RATE * TWIN_STEPS) as f64;
const _: () = assert!(STEPS_PER_TICK == 4);

/// A twin that runs beside the motion shown and differs in all that makes it wrong.
///
/// Its steps are 4/3 as long, which makes it (4/3)^4 = 3.2 times as wrong: where the steps are what is wrong, the two part
/// 2.2 times as far as the motion shown is off. Its roundings are others, of the same size. And its m2 is the next larger
/// number, for the constants of the motion shown are rounded, too. Test `trust` compares it with the exact motion.
#[derive(Clone, Copy, Debug)]
pub struct AccuracyHorizon {
    twin: DirectionStepper,
    until: Option<f64>,
}

impl AccuracyHorizon {
    /// Beside a motion that starts at `start`; the kernel's error if it takes no such motion.
    pub fn new(parameters: &Parameters<f32>, start: &State<f32>) -> Result<Self, Error> {
        let beside = Parameters { m2: parameters.m2.next_up(), ..*parameters };
        Ok(Self { twin: DirectionStepper::new(&beside, start, TWIN_STEP)?, until: None })
    }

    /// Moves on to `time` (s) and compares: `shown` is where the two bobs are shown, `places` says where they would be
    /// shown with the rods in other directions. Once parted, nothing more is computed.
    pub fn tick(&mut self, time: f64, shown: [Place; 2], places: impl FnOnce(Directions) -> [Place; 2]) {
        if self.until.is_some() {
            return;
        }
        self.twin.advance(TWIN_STEPS);
        if are_apart(shown, places(self.twin.directions()), TWIN_LIMIT) {
            self.until = Some(time);
        }
    }

    /// When the frame ceased to be right, s after the start; infinity as long as it is right.
    pub fn until(&self) -> f32 {
        self.until.map_or(f32::INFINITY, |time| time as f32)
    }
}

/// Whether either of two bobs is shown more than `limit` pixels from where it should be, or nobody knows where it is.
pub fn are_apart(shown: [Place; 2], exact: [Place; 2], limit: f32) -> bool {
    let is_near = |((x, y), (exact_x, exact_y)): (Place, Place)| {
        let (dx, dy) = (x - exact_x, y - exact_y);
        dx * dx + dy * dy <= limit * limit
    };
    !shown.into_iter().zip(exact).all(is_near)
}

/// Writes the time and until when the frame can be trusted; the time stands out once it can no longer.
pub fn draw_clock(canvas: &mut Canvas, report: &Report, time_at: Anchor, trust_at: Anchor) {
    let &Report { time, horizon: until, .. } = report;
    let passed = time >= f64::from(until);
    let write = if passed { text::write_marked } else { text::write };
    write(canvas, &label::time(time), time_at);
    text::write(canvas, &label::trust(until), trust_at);
}
