//! The honest clock: until when the picture of a motion is right to half a pixel.

use double_pendulum::State;

use crate::canvas::Canvas;
use crate::compensated::Compensated;
use crate::config::{STEP, STEPS_PER_TICK};
use crate::label;
use crate::text::{self, Anchor};

/// A place on the picture, pixels right and down.
type Place = (f32, f32);

/// A picture that is farther off than this, pixels, is not to be trusted.
pub const HALF_PIXEL: f32 = 0.5;

/// The twin may be half as far off: it is a little wrong itself, and the first moment beyond half a pixel is short.
const TWIN_LIMIT: f32 = 0.5 * HALF_PIXEL;

/// A twin that runs beside the motion shown, in compensated arithmetic and with twice the step.
///
/// A plain `f32` motion at [`STEP`] is wrong above all by rounding, of which the twin makes next to none: so the two
/// part as far as the motion shown is wrong. Where the step itself is what makes it wrong, the twin is 16 times as
/// wrong, and the clock is early rather than late. Test `trust` compares it with the exact motion.
#[derive(Clone, Copy, Debug)]
pub struct Trust {
    twin: Compensated,
    until: Option<f64>,
}

impl Trust {
    /// Beside a motion that starts at `start`.
    pub fn new(start: State<f32>) -> Self {
        Self { twin: Compensated::new(start), until: None }
    }

    /// Moves on to `time` (s) and compares: `shown` is where the two bobs are shown, `places` says where they would be
    /// shown in another state. Once parted, nothing more is computed.
    pub fn tick(
        &mut self,
        time: f64,
        shown: [Place; 2],
        derivatives: impl Fn(&[f32; 4]) -> [f32; 4],
        places: impl FnOnce(&State<f32>) -> [Place; 2],
    ) {
        if self.until.is_some() {
            return;
        }
        for _ in 0..STEPS_PER_TICK / 2 {
            self.twin = self.twin.step(&derivatives, 2.0 * STEP);
        }
        if are_apart(shown, places(&self.twin.state()), TWIN_LIMIT) {
            self.until = Some(time);
        }
    }

    /// When the picture ceased to be right, s after the start; infinity as long as it is right.
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

/// Writes the time and until when the picture can be trusted; the time stands out once it can no longer.
pub fn draw_clock(canvas: &mut Canvas, time: f64, until: f32, time_at: Anchor, trust_at: Anchor) {
    let passed = time >= f64::from(until);
    let write = if passed { text::write_marked } else { text::write };
    write(canvas, &label::time(time), time_at);
    text::write(canvas, &label::trust(until), trust_at);
}
