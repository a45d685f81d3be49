//! Angles to places: where the bobs are and how fast they move.

use crate::numbers::Real;
use crate::pendulum::{Motion, Pendulum};

/// A vector in the plane of motion; the pivot is the origin, x points right, y up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector<R> {
    /// To the right.
    pub x: R,
    /// Upwards.
    pub y: R,
}

impl<R: Real> Vector<R> {
    fn plus(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y }
    }
}

impl<R: Real> Pendulum<R> {
    /// The positions of bob 1 and bob 2 where both rods are at their `angles` (a1, a2), rad; in m.
    ///
    /// x1 = l1 sin a1, y1 = -l1 cos a1, x2 = x1 + l2 sin a2, y2 = y1 - l2 cos a2 (`[math24]`)
    #[must_use]
    pub fn positions(&self, [a1, a2]: [R; 2]) -> [Vector<R>; 2] {
        let rod = |l: R, a: R| {
            let (sin, cos) = a.own_sin_cos();
            Vector { x: l * sin, y: -l * cos }
        };
        let bob1 = rod(self.parameters().l1, a1);
        [bob1, bob1.plus(rod(self.parameters().l2, a2))]
    }

    /// The velocities of bob 1 and bob 2, m/s: the time derivatives of [`positions`](Self::positions).
    ///
    /// x1' = l1 w1 cos a1, y1' = l1 w1 sin a1, x2' = x1' + l2 w2 cos a2, y2' = y1' + l2 w2 sin a2 (`[math24]`)
    #[must_use]
    pub fn velocities(&self, motion: &Motion<R>) -> [Vector<R>; 2] {
        let rod = |l: R, a: R, w: R| {
            let (sin, cos) = a.own_sin_cos();
            Vector { x: l * w * cos, y: l * w * sin }
        };
        let bob1 = rod(self.parameters().l1, motion.a1, motion.w1);
        [bob1, bob1.plus(rod(self.parameters().l2, motion.a2, motion.w2))]
    }
}
