//! An added method, in the unit tests only: RK4 on Lagrange's equations, in `f32`.

use super::{Canonical, Derivatives};
use crate::error::Error;
use crate::numbers::Real;
use crate::pendulum::{Motion, Parameters, Pendulum, State};

/// The method `rk4-f32-lagrange`. It takes the same inputs as [`HamiltonF32`](super::HamiltonF32):
/// a step is dt rounded to `f32`, and angles include whole turns.
pub type LagrangeF32 = Canonical<f32, Lagrange<f32>>;

/// The price of a step by this method on every processor, in cycles. It is chosen for the tests,
/// not measured.
pub const PRICE: f32 = 1e4;

/// Lagrange's equations with the momenta as variables: a' = M^-1 p, p' = dL/da, where M is
/// [`Pendulum::mass_matrix`] and L is [`Pendulum::lagrangian`]. Angles a are in rad, momenta p in
/// kg m^2/s, and a' and p' in rad/s and N m. The exact motion is that of Hamilton's equations. A
/// state that is not finite gives NaN or infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lagrange<R>(Pendulum<R>);

impl<R: Real> Derivatives<R> for Lagrange<R> {
    fn prepare(parameters: &Parameters<R>) -> Result<Self, Error> {
        Pendulum::new(parameters).map(Self)
    }

    fn derivatives(&self, z: &[R; 4]) -> [R; 4] {
        let Motion { a1, a2, w1, w2 } = self.0.to_motion(&State::from(*z));
        let [sin1, _] = sin_cos(a1);
        let [sin2, _] = sin_cos(a2);
        let [sin_d, _] = sin_cos(a1 - a2);
        let [[torque1, _], [_, torque2]] = self.0.stiffness();
        let [[_, coupling], _] = self.0.mass_matrix(R::ONE);
        let force = coupling * w1 * w2 * sin_d;
        [w1, w2, -torque1 * sin1 - force, -torque2 * sin2 + force]
    }
}

/// Returns (sin, cos) of an angle, rad.
fn sin_cos<R: Real>(angle: R) -> [R; 2] {
    angle.own_sin_cos().into()
}
