//! The Legendre transformation between angular velocities and canonical momenta, both ways.

use crate::numbers::Real;
use crate::pendulum::{Motion, Parameters, Pendulum, State};

impl<R: Real> Pendulum<R> {
    /// The mass matrix M at the angle D = a1 - a2 between the rods, kg m^2, row by row; `cos_d` is cos D.
    ///
    /// M = [[(m1 + m2) l1^2, m2 l1 l2 cos D], [m2 l1 l2 cos D, m2 l2^2]], so that T = w.M w/2 and p = M w.
    #[must_use]
    pub fn mass_matrix(&self, cos_d: R) -> [[R; 2]; 2] {
        let &Parameters { m1, m2, l1, l2, .. } = self.parameters();
        let coupling = m2 * l1 * l2 * cos_d;
        [[(m1 + m2) * l1 * l1, coupling], [coupling, m2 * l2 * l2]]
    }

    /// Velocities to momenta, p_i = dL/dw_i.
    ///
    /// - p1 = (m1 + m2) l1^2 w1 + m2 l1 l2 w2 cos D
    /// - p2 = m2 l2^2 w2 + m2 l1 l2 w1 cos D
    ///
    /// (`[math24]`, where the second term of p2 is misprinted with w2.)
    #[must_use]
    pub fn to_state(&self, motion: &Motion<R>) -> State<R> {
        let &Motion { a1, a2, w1, w2 } = motion;
        let (_, cos_d) = (a1 - a2).own_sin_cos();
        let [[m11, m12], [m21, m22]] = self.mass_matrix(cos_d);
        State { a1, a2, p1: m11 * w1 + m12 * w2, p2: m21 * w1 + m22 * w2 }
    }

    /// Momenta to velocities, w = M^-1 p: the first pair of Hamilton's equations.
    ///
    /// With m2 much greater than m1 and parallel rods p1 l2 and p2 l1 nearly cancel: the relative error of w1 is then
    /// up to m2/m1 roundings in any formula, because the momenta themselves are given to one rounding only.
    #[must_use]
    pub fn to_motion(&self, state: &State<R>) -> Motion<R> {
        let &State { a1, a2, .. } = state;
        let [w1, w2, ..] = self.derivatives(&(*state).into());
        Motion { a1, a2, w1, w2 }
    }
}
