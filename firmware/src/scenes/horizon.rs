//! The accuracy clock: until when the frame of a motion is right to half a pixel.

use crate::graphics::{Anchor, Canvas, label, text};
use crate::scenes::Report;

/// A point of the frame, pixels right and down.
pub type Point = (f32, f32);

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

/// Whether either of two bobs is shown more than `limit` pixels from where it should be, or at no place at all.
pub fn are_apart(shown: [Point; 2], exact: [Point; 2], limit: f32) -> bool {
    let is_near = |((x, y), (exact_x, exact_y)): (Point, Point)| {
        let (dx, dy) = (x - exact_x, y - exact_y);
        dx * dx + dy * dy <= limit * limit
    };
    !shown.into_iter().zip(exact).all(is_near)
}

/// Writes the time and until when the frame can be trusted; the time stands out once it is known that it no longer can.
pub fn draw_clock(canvas: &mut Canvas, report: &Report, time_at: Anchor, trust_at: Anchor) {
    let &Report { time, horizon: until, is_looking, .. } = report;
    let passed = !is_looking && time > f64::from(until);
    let write = if passed { text::write_marked } else { text::write };
    write(canvas, &label::time(time), time_at);
    text::write(canvas, &label::trust(until, is_looking), trust_at);
}
