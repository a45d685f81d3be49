//! Hamilton's canonical equations for any masses and lengths.

use crate::error::Error;
use crate::numbers::Real;
use crate::pendulum::{Parameters, State};

/// A double pendulum: validated parameters, and the products of them that the equations use.
///
/// It has no state of motion. One pendulum serves any number of [`State`]s.
///
/// Unless stated otherwise, the functions do not check the angles, momenta and velocities that they
/// are called with. Numbers that are not finite, or that overflow, give NaN or infinity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pendulum<R> {
    parameters: Parameters<R>,
    /// 1/l1 and 1/l2.
    inverse_length: [R; 2],
    /// (m1 + m2)/m2.
    total_over_m2: R,
    /// m2 l1 l2.
    coupling: R,
    /// The largest torques of gravity on the joints, (m1 + m2) g l1 and m2 g l2, N m.
    pub(crate) torque: [R; 2],
}

impl<R: Real> Pendulum<R> {
    /// Checks the parameters and prepares the equations.
    ///
    /// # Errors
    ///
    /// Refuses the first parameter, in the order m1, m2, l1, l2, g, that is NaN or infinite
    /// ([`Error::NotFinite`]), zero or negative ([`Error::NotPositive`]), or below 1e-9 or above
    /// 1e9 ([`Error::TooSmall`], [`Error::TooLarge`]). Zero gravity is allowed.
    pub fn new(parameters: &Parameters<R>) -> Result<Self, Error> {
        parameters.check()?;
        Ok(Self::unchecked(parameters))
    }

    /// Prepares the equations of parameters that are known to be valid.
    pub(crate) fn unchecked(parameters: &Parameters<R>) -> Self {
        let &Parameters { m1, m2, l1, l2, g } = parameters;
        Self {
            parameters: *parameters,
            inverse_length: [R::ONE / l1, R::ONE / l2],
            total_over_m2: (m1 + m2) / m2,
            coupling: m2 * l1 * l2,
            torque: [(m1 + m2) * g * l1, m2 * g * l2],
        }
    }

    /// Returns true if a pendulum in this state never moves: each rod hangs or stands straight up,
    /// or there is no gravity, and nothing turns.
    #[must_use]
    pub fn rests(&self, state: &State<R>) -> bool {
        self.derivatives(&(*state).into()) == [R::ZERO; 4]
    }

    /// Returns the parameters.
    #[must_use]
    pub fn parameters(&self) -> &Parameters<R> {
        &self.parameters
    }

    /// Returns the time derivatives (w1, w2, p1', p2') of z = (a1, a2, p1, p2) by Hamilton's
    /// equations, in rad/s and N m. z is in rad and kg m^2/s.
    ///
    /// With D = a1 - a2 and den = m1 + m2 sin^2 D:
    ///
    /// - w1 = (p1 l2 - p2 l1 cos D) / (l1^2 l2 den)
    /// - w2 = (p2 (m1 + m2) l1 - p1 m2 l2 cos D) / (m2 l1 l2^2 den)
    /// - p1' = -(m1 + m2) g l1 sin a1 - F
    /// - p2' = -m2 g l2 sin a2 + F
    ///
    /// Here F = m2 l1 l2 w1 w2 sin D, which `[math24]` writes as A1 - A2. The cost is two sincos
    /// and one division.
    ///
    /// The difference from the form of `[math24]` is at most 1e-13 (`f64`) or 2e-6 (`f32`) of the
    /// largest term (test `hamilton`).
    #[must_use]
    pub fn derivatives(&self, z: &[R; 4]) -> [R; 4] {
        let &[a1, a2, p1, p2] = z;
        self.derivatives_at([a1.own_sin_cos().into(), a2.own_sin_cos().into()], [p1, p2])
    }

    /// Returns the [`derivatives`](Self::derivatives) for known directions of both rods, without
    /// trigonometry.
    #[doc(hidden)] // For the firmware's method with other sines.
    #[must_use]
    pub fn derivatives_at(
        &self,
        [[sin1, cos1], [sin2, cos2]]: [[R; 2]; 2],
        [p1, p2]: [R; 2],
    ) -> [R; 4] {
        let Parameters { m1, m2, .. } = self.parameters;
        let [inverse_l1, inverse_l2] = self.inverse_length;
        let [torque1, torque2] = self.torque;

        let sin_d = sin1 * cos2 - cos1 * sin2;
        let cos_d = cos1 * cos2 + sin1 * sin2;

        let q1 = p1 * inverse_l1;
        let q2 = p2 * inverse_l2;
        let inverse_den = R::ONE / (m1 + m2 * sin_d * sin_d);
        let w1 = (q1 - q2 * cos_d) * inverse_den * inverse_l1;
        let w2 = (q2 * self.total_over_m2 - q1 * cos_d) * inverse_den * inverse_l2;

        let force = self.coupling * w1 * w2 * sin_d;
        [w1, w2, -torque1 * sin1 - force, -torque2 * sin2 + force]
    }

    /// Returns the Hamiltonian H = T + V of the canonical state, J. It is zero if both bobs are at
    /// rest at the height of the pivot.
    ///
    /// H = (q1 - q2 cos D)^2 / (2 den) + q2^2 / (2 m2) - (m1 + m2) g l1 cos a1 - m2 g l2 cos a2
    ///
    /// with q1 = p1/l1, q2 = p2/l2 and the D and den of [`derivatives`](Self::derivatives). The
    /// kinetic energy is a sum of squares, so that it cannot be negative. The exact motion
    /// conserves H; its minimum is [`least_energy`](Self::least_energy). The cost is three sincos
    /// and two divisions.
    #[must_use]
    pub fn energy(&self, state: &State<R>) -> R {
        let (_, cos1) = state.a1.own_sin_cos();
        let (_, cos2) = state.a2.own_sin_cos();
        self.kinetic_energy_of((state.a1 - state.a2).own_sin_cos(), [state.p1, state.p2])
            - self.torque[0] * cos1
            - self.torque[1] * cos2
    }

    /// Returns the [`energy`](Self::energy) for known directions of both rods.
    pub(crate) fn energy_at(
        &self,
        [[sin1, cos1], [sin2, cos2]]: [[R; 2]; 2],
        momenta: [R; 2],
    ) -> R {
        let elbow = (sin1 * cos2 - cos1 * sin2, cos1 * cos2 + sin1 * sin2);
        self.kinetic_energy_of(elbow, momenta) - self.torque[0] * cos1 - self.torque[1] * cos2
    }

    /// Returns the energy above rest, K = H - min V, J.
    ///
    /// K = T + (m1 + m2) g l1 (1 - cos a1) + m2 g l2 (1 - cos a2)
    ///
    /// No term is negative, so that K keeps its relative precision for the smallest motions, where
    /// H and min V nearly cancel.
    #[must_use]
    pub fn energy_above_rest(&self, state: &State<R>) -> R {
        let height1 = one_minus_cos(state.a1.own_sin_cos());
        let height2 = one_minus_cos(state.a2.own_sin_cos());
        self.kinetic_energy_of((state.a1 - state.a2).own_sin_cos(), [state.p1, state.p2])
            + self.torque[0] * height1
            + self.torque[1] * height2
    }

    /// Returns the [energy above rest](Self::energy_above_rest) for known directions of both rods.
    pub(crate) fn energy_above_rest_at(
        &self,
        [[sin1, cos1], [sin2, cos2]]: [[R; 2]; 2],
        momenta: [R; 2],
    ) -> R {
        let elbow = (sin1 * cos2 - cos1 * sin2, cos1 * cos2 + sin1 * sin2);
        self.kinetic_energy_of(elbow, momenta)
            + self.torque[0] * one_minus_cos((sin1, cos1))
            + self.torque[1] * one_minus_cos((sin2, cos2))
    }

    /// Returns the least possible energy, J, that of hanging at rest: min V = -(m1 + m2) g l1 - m2
    /// g l2.
    #[must_use]
    pub fn least_energy(&self) -> R {
        -(self.torque[0] + self.torque[1])
    }

    fn kinetic_energy_of(&self, (sin_d, cos_d): (R, R), [p1, p2]: [R; 2]) -> R {
        let Parameters { m1, m2, .. } = self.parameters;
        let q1 = p1 * self.inverse_length[0];
        let q2 = p2 * self.inverse_length[1];
        let den = m1 + m2 * sin_d * sin_d;
        let q = q1 - q2 * cos_d;
        // A square alone may underflow in `f32`.
        R::HALF * (q * (q / den) + q2 * (q2 / m2))
    }
}

/// Returns 1 - cos a, without cancellation for small a: sin^2 a / (1 + cos a) if cos a > 1/2.
fn one_minus_cos<R: Real>((sin, cos): (R, R)) -> R {
    if cos > R::HALF {
        sin * sin / (R::ONE + cos)
    } else {
        R::ONE - cos
    }
}
