//! Hamilton's equations for rods of equal length, in dimensionless form: the mass ratio is the only parameter.

use crate::error::{Error, Parameter};
use crate::numbers::Real;
use crate::numbers::trig::{Own, SinCos};
use crate::pendulum::{Parameters, State};

/// A double pendulum with rods of equal length l, in its own units: [`Units`] converts to and from SI.
///
/// Time is counted in sqrt(l/g), angular velocity in sqrt(g/l), momenta in m1 l^2 sqrt(g/l), energy in m1 g l. Only the
/// mass ratio mu = m2/m1 is left, and an evaluation costs four multiplications less than
/// [`Pendulum`](crate::Pendulum), which gives the same motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EqualRods<R> {
    mu: R,
    /// 1 + mu.
    total: R,
    /// (1 + mu)/mu.
    total_over_mu: R,
}

impl<R: Real> EqualRods<R> {
    /// Prepares the equations for the mass ratio `mu` = m2/m1, with the default source of sine and cosine.
    ///
    /// Refuses a ratio that is NaN, infinite, zero, negative or so extreme that (1 + mu)/mu leaves the range of `R`.
    pub fn new(mu: R) -> Result<Self, Error> {
        let (parameter, value) = (Parameter::Mu, mu.to_f64());
        if !mu.is_finite() {
            return Err(Error::NotFinite { parameter, value });
        }
        if mu <= R::ZERO {
            return Err(Error::NotPositive { parameter, value });
        }
        let total = R::ONE + mu;
        let total_over_mu = total / mu;
        if mu.is_normal() && total.is_finite() && total_over_mu.is_finite() {
            Ok(Self { mu, total, total_over_mu })
        } else {
            Err(Error::OutOfRange { parameter, value })
        }
    }

    /// The same pendulum as masses, lengths and gravity, in its own units: m1 = l1 = l2 = g = 1, m2 = mu.
    #[doc(hidden)]
    pub fn parameters(&self) -> Parameters<R> {
        Parameters::equal_rods(self.mu, R::ONE, R::ONE)
    }

    /// Hamilton's equations: the derivatives of (a1, a2, p1, p2) with respect to time in sqrt(l/g), in that order.
    ///
    /// With D = a1 - a2 and den = 1 + mu sin^2 D,
    ///
    /// - w1 = (p1 - p2 cos D) / den
    /// - w2 = (p2 (1 + mu) - p1 mu cos D) / (mu den)
    /// - p1' = -(1 + mu) sin a1 - F
    /// - p2' = -mu sin a2 + F
    ///
    /// where F = mu w1 w2 sin D. (`[math24]`, whose w2 lacks the factor mu in the denominator.) Two sincos and one
    /// division.
    #[must_use]
    #[inline]
    pub fn derivatives(&self, z: &[R; 4]) -> [R; 4] {
        let &[a1, a2, p1, p2] = z;
        let (sin1, cos1) = Own::sin_cos(a1);
        let (sin2, cos2) = Own::sin_cos(a2);
        let sin_d = sin1 * cos2 - cos1 * sin2;
        let cos_d = cos1 * cos2 + sin1 * sin2;

        let inverse_den = R::ONE / (R::ONE + self.mu * sin_d * sin_d);
        let w1 = (p1 - p2 * cos_d) * inverse_den;
        let w2 = (p2 * self.total_over_mu - p1 * cos_d) * inverse_den;

        let force = self.mu * w1 * w2 * sin_d;
        [w1, w2, -self.total * sin1 - force, -self.mu * sin2 + force]
    }

    /// The Hamiltonian in m1 g l; zero where both bobs are level with the pivot.
    ///
    /// H = (p1 - p2 cos D)^2 / (2 den) + p2^2 / (2 mu) - (1 + mu) cos a1 - mu cos a2
    #[must_use]
    pub fn energy(&self, state: &State<R>) -> R {
        let (_, cos1) = Own::sin_cos(state.a1);
        let (_, cos2) = Own::sin_cos(state.a2);
        self.kinetic_energy_of(state) - self.total * cos1 - self.mu * cos2
    }

    fn kinetic_energy_of(&self, state: &State<R>) -> R {
        let (sin_d, cos_d) = Own::sin_cos(state.a1 - state.a2);
        let q = state.p1 - state.p2 * cos_d;
        R::HALF * (q * q / (R::ONE + self.mu * sin_d * sin_d) + state.p2 * state.p2 / self.mu)
    }
}

/// What one unit of the dimensionless equal-rod form is in SI units.
///
/// ```
/// use double_pendulum::{EqualRods, Parameters, State, Units};
///
/// let parameters = Parameters { m1: 2.0, m2: 1.0, l1: 0.25, l2: 0.25, g: 9.8 };
/// let units = Units::of(&parameters)?;
/// let rods = EqualRods::new(parameters.mass_ratio())?;
/// let start = State::at_rest(0.5_f64, 1.0);
/// let later = units.to_si(&rods.step(&units.from_si(&start), 0.001 / units.time));
/// assert!((later.p1 + 0.001 * 3.0 * 9.8 * 0.25 * 0.5_f64.sin()).abs() < 1e-6); // p1' = -(m1 + m2) g l sin a1
/// # Ok::<(), double_pendulum::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units<R> {
    /// sqrt(l/g), s.
    pub time: R,
    /// sqrt(g/l), rad/s.
    pub angular_velocity: R,
    /// m1 l^2 sqrt(g/l), kg m^2/s.
    pub momentum: R,
    /// m1 g l, J.
    pub energy: R,
}

impl<R: Real> Units<R> {
    /// The units that belong to `parameters`.
    ///
    /// Refuses rods of unequal length, no gravity, what [`Pendulum::new`](crate::Pendulum::new) refuses, and units out
    /// of the range of `R`.
    pub fn of(parameters: &Parameters<R>) -> Result<Self, Error> {
        parameters.check_swinging()?;
        let &Parameters { m1, l1, l2, g, .. } = parameters;
        if l1 != l2 {
            return Err(Error::UnequalRods { l1: l1.to_f64(), l2: l2.to_f64() });
        }
        let angular_velocity = (g / l1).sqrt();
        let units = Self {
            time: (l1 / g).sqrt(),
            angular_velocity,
            momentum: m1 * l1 * l1 * angular_velocity,
            energy: m1 * g * l1,
        };
        let Self { time, momentum, energy, .. } = units;
        if [time, angular_velocity, momentum, energy].into_iter().all(R::is_normal) {
            Ok(units)
        } else {
            Err(parameters.out_of_range())
        }
    }

    /// A dimensionless state in SI units.
    #[must_use]
    pub fn to_si(&self, state: &State<R>) -> State<R> {
        State { p1: state.p1 * self.momentum, p2: state.p2 * self.momentum, ..*state }
    }

    /// A state in SI units made dimensionless.
    #[must_use]
    pub fn from_si(&self, state: &State<R>) -> State<R> {
        State { p1: state.p1 / self.momentum, p2: state.p2 / self.momentum, ..*state }
    }
}
