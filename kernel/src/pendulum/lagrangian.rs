//! The equations in angles and angular velocities: positions, the Lagrangian, Lagrange's equations,
//! and the Legendre transformation to canonical momenta and back.
//!
//! Except for the transformation, they share no formula with
//! [Hamilton's equations](crate::Pendulum::derivatives), so that each form is a check of the other.

use crate::numbers::Real;
use crate::pendulum::{Motion, Parameters, Pendulum, State};

/// A vector in the plane of motion: a position, m, or a velocity, m/s. The pivot is the origin, x
/// points right, y up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector<R> {
    /// The horizontal part, positive to the right.
    pub x: R,
    /// The vertical part, positive upwards.
    pub y: R,
}

impl<R: Real> Vector<R> {
    fn plus(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
        }
    }
}

impl<R: Real> Pendulum<R> {
    /// Returns the positions of bob 1 and bob 2, m, for the angles (a1, a2), rad.
    ///
    /// x1 = l1 sin a1, y1 = -l1 cos a1, x2 = x1 + l2 sin a2, y2 = y1 - l2 cos a2 (`[math24]`)
    #[must_use]
    pub fn positions(&self, [a1, a2]: [R; 2]) -> [Vector<R>; 2] {
        let rod = |l: R, a: R| {
            let (sin, cos) = a.own_sin_cos();
            Vector {
                x: l * sin,
                y: -l * cos,
            }
        };
        let bob1 = rod(self.parameters().l1, a1);
        [bob1, bob1.plus(rod(self.parameters().l2, a2))]
    }

    /// Returns the velocities of bob 1 and bob 2, m/s.
    ///
    /// x1' = l1 w1 cos a1, y1' = l1 w1 sin a1, x2' = x1' + l2 w2 cos a2, y2' = y1' + l2 w2 sin a2
    /// (`[math24]`)
    #[must_use]
    pub fn velocities(&self, motion: &Motion<R>) -> [Vector<R>; 2] {
        let rod = |l: R, a: R, w: R| {
            let (sin, cos) = a.own_sin_cos();
            Vector {
                x: l * w * cos,
                y: l * w * sin,
            }
        };
        let bob1 = rod(self.parameters().l1, motion.a1, motion.w1);
        [
            bob1,
            bob1.plus(rod(self.parameters().l2, motion.a2, motion.w2)),
        ]
    }

    /// Returns the kinetic energy, J (`[math24]`, "Lagrange equations").
    ///
    /// T = (m1 + m2)/2 l1^2 w1^2 + m2/2 l2^2 w2^2 + m2 l1 l2 w1 w2 cos(a1 - a2)
    ///
    /// If the terms nearly cancel, their rounding may make the result slightly negative.
    #[must_use]
    pub fn kinetic_energy(&self, motion: &Motion<R>) -> R {
        let &Motion { w1, w2, .. } = motion;
        let &Parameters { m1, m2, l1, l2, .. } = self.parameters();
        let (_, cos_d) = elbow(motion);
        let v1 = l1 * w1;
        let v2 = l2 * w2;
        R::HALF * (m1 + m2) * v1 * v1 + R::HALF * m2 * v2 * v2 + m2 * v1 * v2 * cos_d
    }

    /// Returns the potential energy, J, for the angles (a1, a2), rad. It is zero if both bobs are
    /// at the height of the pivot.
    ///
    /// V = -(m1 + m2) g l1 cos a1 - m2 g l2 cos a2 (`[math24]`)
    #[must_use]
    pub fn potential_energy(&self, [a1, a2]: [R; 2]) -> R {
        let &Parameters { m1, m2, l1, l2, g } = self.parameters();
        let (_, cos1) = a1.own_sin_cos();
        let (_, cos2) = a2.own_sin_cos();
        -(m1 + m2) * g * l1 * cos1 - m2 * g * l2 * cos2
    }

    /// Returns the Lagrangian L = T - V, J.
    #[must_use]
    pub fn lagrangian(&self, motion: &Motion<R>) -> R {
        self.kinetic_energy(motion) - self.potential_energy(motion.angles())
    }

    /// Returns the angular accelerations (w1', w2'), rad/s^2: the solution of Lagrange's equations.
    ///
    /// With D = a1 - a2 the equations are (`[math24]`):
    ///
    /// - (m1 + m2) l1 w1' + m2 l2 w2' cos D = -m2 l2 w2^2 sin D - (m1 + m2) g sin a1
    /// - l1 w1' cos D + l2 w2' = l1 w1^2 sin D - g sin a2
    ///
    /// Their determinant is l1 l2 (m1 + m2 sin^2 D), which is never zero.
    #[must_use]
    pub fn accelerations(&self, motion: &Motion<R>) -> [R; 2] {
        let &Motion { a1, a2, w1, w2 } = motion;
        let &Parameters { m1, m2, l1, l2, g } = self.parameters();
        let total = m1 + m2;
        let (sin1, _) = a1.own_sin_cos();
        let (sin2, _) = a2.own_sin_cos();
        let (sin_d, cos_d) = elbow(motion);

        let f1 = -m2 * l2 * w2 * w2 * sin_d - total * g * sin1;
        let f2 = l1 * w1 * w1 * sin_d - g * sin2;
        let den = m1 + m2 * sin_d * sin_d;
        [
            (f1 - m2 * cos_d * f2) / (l1 * den),
            (total * f2 - cos_d * f1) / (l2 * den),
        ]
    }

    /// Returns the mass matrix M, kg m^2, row by row, where `cos_d` is cos(a1 - a2).
    ///
    /// M = [[(m1 + m2) l1^2, m2 l1 l2 cos D], [m2 l1 l2 cos D, m2 l2^2]], so that T = w.M w/2 and
    /// p = M w.
    #[must_use]
    pub fn mass_matrix(&self, cos_d: R) -> [[R; 2]; 2] {
        let &Parameters { m1, m2, l1, l2, .. } = self.parameters();
        let coupling = m2 * l1 * l2 * cos_d;
        [[(m1 + m2) * l1 * l1, coupling], [coupling, m2 * l2 * l2]]
    }

    /// Converts angular velocities to momenta, p_i = dL/dw_i, kg m^2/s. The angles are kept.
    ///
    /// - p1 = (m1 + m2) l1^2 w1 + m2 l1 l2 w2 cos D
    /// - p2 = m2 l2^2 w2 + m2 l1 l2 w1 cos D
    ///
    /// In `[math24]` the second term of p2 is misprinted with w2.
    #[must_use]
    pub fn to_state(&self, motion: &Motion<R>) -> State<R> {
        let &Motion { a1, a2, w1, w2 } = motion;
        let (_, cos_d) = elbow(motion);
        let [[m11, m12], [m21, m22]] = self.mass_matrix(cos_d);
        State {
            a1,
            a2,
            p1: m11 * w1 + m12 * w2,
            p2: m21 * w1 + m22 * w2,
        }
    }

    /// Converts momenta to angular velocities, w = M^-1 p, rad/s: the first pair of Hamilton's
    /// equations. The angles are kept.
    ///
    /// If m2 is much larger than m1 and the rods are parallel, p1 l2 and p2 l1 nearly cancel. The
    /// relative error of w1 is then up to m2/m1 roundings by any formula, because the momenta
    /// themselves are rounded.
    #[must_use]
    pub fn to_motion(&self, state: &State<R>) -> Motion<R> {
        let &State { a1, a2, .. } = state;
        let [w1, w2, ..] = self.derivatives(&(*state).into());
        Motion { a1, a2, w1, w2 }
    }
}

fn elbow<R: Real>(motion: &Motion<R>) -> (R, R) {
    (motion.a1 - motion.a2).own_sin_cos()
}
