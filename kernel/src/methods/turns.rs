//! Counts whole turns, which directions alone do not tell.

use crate::numbers::Real;
use crate::pendulum::Direction;

/// Counts how often a direction passes the upward vertical.
///
/// Show it the direction at least once every quarter turn; then [`angle`](Self::angle) is the unwrapped angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding<R> {
    turns: i32,
    last: Direction<R>,
}

impl<R: Real> Winding<R> {
    /// For an angle of `start` rad.
    #[must_use]
    #[inline(never)] // one copy
    pub fn new(start: R) -> Self {
        let (turns, rest) = split(start.to_f64());
        let (sin, cos) = rest.own_sin_cos();
        Self { turns, last: [R::from_f64(sin), R::from_f64(cos)] }
    }

    /// Takes note of the direction (sin, cos) the angle has now.
    #[inline]
    pub fn observe(&mut self, now: Direction<R>) {
        let above = now[1] < R::ZERO && self.last[1] < R::ZERO;
        let [before, after] = [self.last[0] < R::ZERO, now[0] < R::ZERO];
        if above && before != after {
            self.turns = self.turns.wrapping_add(if after { 1 } else { -1 });
        }
        self.last = now;
    }

    /// For an angle of `start` rad, whose direction is `now`: no sines, the sign of one tells the side.
    #[inline(never)] // one copy
    pub(crate) fn at(start: R, now: Direction<R>) -> Self {
        let (turns, rest) = split(start.to_f64());
        let mut winding = Self { turns, last: [R::from_f64(rest), -R::ONE] };
        winding.observe(now);
        winding
    }

    /// The last direction observed.
    pub(crate) fn last(&self) -> Direction<R> {
        self.last
    }

    /// Whole turns, counted from the downward vertical.
    #[must_use]
    pub fn turns(&self) -> i32 {
        self.turns
    }

    /// The unwrapped angle, rad, as of the last direction observed.
    #[must_use]
    #[inline(never)] // one copy
    pub fn angle(&self) -> R {
        let [s, c] = self.last;
        R::from_f64(f64::from(self.turns) * core::f64::consts::TAU) + s.atan2(c)
    }

    /// `angle`, known but for whole turns, as many turns on as bring it nearest to [`angle`](Self::angle), rad: the
    /// digits of [`Form::state`](super::Form::state) and the turns from here.
    ///
    /// No trigonometry: a quarter turn to the side of the last direction is within half a turn of it, near enough.
    #[must_use]
    #[inline(never)] // one copy
    pub fn unwrap(&self, angle: f64) -> f64 {
        use core::f64::consts::{FRAC_PI_2, TAU};
        let side = if self.last[0] < R::ZERO { -FRAC_PI_2 } else { FRAC_PI_2 };
        let near = f64::from(self.turns) * TAU + side;
        angle + TAU * libm::rint((near - angle) / TAU)
    }
}

/// The whole turns of an angle, and the rest, rad.
#[inline(never)] // one copy
fn split(angle: f64) -> (i32, f64) {
    let turns = libm::rint(angle / core::f64::consts::TAU);
    (turns as i32, angle - turns * core::f64::consts::TAU)
}
