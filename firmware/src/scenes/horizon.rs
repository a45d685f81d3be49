//! The accuracy clock: until when the frame of a motion is right to half a pixel.

use double_pendulum::{Error, Parameters, State};

use crate::config::{HALF_PIXEL, STEPS_PER_TICK, TICK_RATE};
use crate::graphics::canvas::Canvas;
use crate::graphics::label;
use crate::graphics::text::{self, Anchor};
use crate::motion::direction_stepper::{DirectionStepper, Directions};
use crate::scenes::scene::Report;

/// A point of the frame, pixels right and down.
pub type Point = (f32, f32);

/// A shadow run of the same kind may be half as far off: where both are as wrong, they may by chance be so in the same way.
const SHADOW_LIMIT: f32 = 0.5 * HALF_PIXEL;

/// The shadow run's steps in a tick, where the motion shown makes four.
const SHADOW_STEPS: u32 = 3;
const SHADOW_DT: f64 = 1.0 / (TICK_RATE * SHADOW_STEPS) as f64;
const _: () = assert!(STEPS_PER_TICK == 4);

/// Until when every frame was right: the time of the last one before the first that was not.
#[derive(Clone, Copy, Debug, Default)]
pub struct LastRight {
    time: f64,
    is_over: bool,
}

impl LastRight {
    /// Takes note of the frame at `time`, s. Once one was wrong, nothing changes.
    pub fn note(&mut self, time: f64, is_right: bool) {
        self.is_over |= !is_right;
        if !self.is_over {
            self.time = time;
        }
    }

    /// The time of the last right frame, s after the start; infinity as long as all are.
    pub fn until(&self) -> f32 {
        if self.is_over { self.time as f32 } else { f32::INFINITY }
    }
}

/// A shadow run beside the motion shown: the exact motion as far as `f32` knows it, with other errors.
///
/// Its steps are 4/3 as long, which makes it (4/3)^4 = 3.2 times as wrong: where the steps are what is wrong, the two part
/// 2.2 times as far as the motion shown is off. Its roundings are others, of the same size. And its m2 is the next larger
/// number, for the constants of the motion shown are rounded, too. Test `horizon` compares it with the exact motion, of which
/// it is hardly ever late, and with the plan, which looks ahead by other runs and may say a fifth more or less.
#[derive(Clone, Copy, Debug)]
pub struct AccuracyHorizon {
    shadow: DirectionStepper,
    /// How far it may be off, pixels.
    limit: f32,
    right: LastRight,
}

impl AccuracyHorizon {
    /// Beside a motion that starts at `start`; the kernel's error if it takes no such motion.
    pub fn new(parameters: &Parameters<f32>, start: &State<f32>) -> Result<Self, Error> {
        let beside = Parameters { m2: parameters.m2.next_up(), ..*parameters };
        let shadow = DirectionStepper::new(&beside, start, SHADOW_DT)?;
        Ok(Self { shadow, limit: SHADOW_LIMIT, right: LastRight::default() })
    }

    /// The same beside a model of that motion, far more wrong than the shadow run is.
    pub fn of_model(parameters: &Parameters<f32>, start: &State<f32>) -> Result<Self, Error> {
        Ok(Self { limit: HALF_PIXEL, ..Self::new(parameters, start)? })
    }

    /// Moves on to `time` (s) and compares: `shown` is where the two bobs are shown, `places` says where they would be
    /// shown with the rods in other directions. Once parted, nothing more is computed.
    pub fn tick(&mut self, time: f64, shown: [Point; 2], places: impl FnOnce(Directions) -> [Point; 2]) {
        if self.is_reached() {
            return;
        }
        self.shadow.advance(SHADOW_STEPS);
        self.right.note(time, !are_apart(shown, places(self.shadow.directions()), self.limit));
    }

    /// Whether a frame has been wrong.
    pub fn is_reached(&self) -> bool {
        self.right.is_over
    }

    /// As [`LastRight::until`].
    pub fn until(&self) -> f32 {
        self.right.until()
    }
}

/// Whether either of two bobs is shown more than `limit` pixels from where it should be, or at no place at all.
pub fn are_apart(shown: [Point; 2], exact: [Point; 2], limit: f32) -> bool {
    let is_near = |((x, y), (exact_x, exact_y)): (Point, Point)| {
        let (dx, dy) = (x - exact_x, y - exact_y);
        dx * dx + dy * dy <= limit * limit
    };
    !shown.into_iter().zip(exact).all(is_near)
}

/// Writes the time and until when the frame can be trusted; the time stands out once it can no longer.
pub fn draw_clock(canvas: &mut Canvas, report: &Report, time_at: Anchor, trust_at: Anchor) {
    let &Report { time, horizon: until, .. } = report;
    let passed = time > f64::from(until);
    let write = if passed { text::write_marked } else { text::write };
    write(canvas, &label::time(time), time_at);
    text::write(canvas, &label::trust(until), trust_at);
}
