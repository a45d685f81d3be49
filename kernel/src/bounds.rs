//! Bounds that hold for every motion, from its energy alone.

use crate::error::{Error, Parameter};
use crate::numbers::Real;
use crate::pendulum::{Parameters, Pendulum, State};
use crate::small::Modes;

/// The greatest magnitudes that a motion of given energy can reach; each is reached by some motion of that energy.
///
/// With K the energy above hanging rest (J), all of it kinetic at best: T >= m1 v1^2/2, T >= m2 v2^2/2, and by completing
/// squares in T the same for each w and p alone. Exact up to the rounding of K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<R> {
    /// |w1| <= sqrt(2 K/m1)/l1, rad/s.
    pub w1: R,
    /// |w2| <= sqrt(2 K (m1 + m2)/(m1 m2))/l2, rad/s.
    pub w2: R,
    /// |w1 - w2| <= sqrt(2 K (l1^2/m2 + (l1 + l2)^2/m1))/(l1 l2), the rate at which the elbow bends, rad/s; the largest
    /// of the three rates.
    pub elbow: R,
    /// |p1| <= l1 sqrt(2 (m1 + m2) K), kg m^2/s.
    pub p1: R,
    /// |p2| <= l2 sqrt(2 m2 K), kg m^2/s.
    pub p2: R,
    /// The speed of bob 1, v1 <= sqrt(2 K/m1), m/s.
    pub v1: R,
    /// The speed of bob 2, v2 <= sqrt(2 K/m2), m/s.
    pub v2: R,
}

impl<R: Real> Bounds<R> {
    #[inline(never)]
    pub(crate) fn new(parameters: &Parameters<R>, energy_above_rest: R) -> Self {
        let &Parameters { m1, m2, l1, l2, .. } = parameters;
        let twice = R::TWO * energy_above_rest;
        let v1 = (twice / m1).sqrt();
        let v2 = (twice / m2).sqrt();
        Self {
            w1: v1 / l1,
            w2: v2 * ((m1 + m2) / m1).sqrt() / l2,
            elbow: v2 * (l1 * l1 + m2 / m1 * (l1 + l2) * (l1 + l2)).sqrt() / l1 / l2,
            p1: l1 * ((m1 + m2) * twice).sqrt(),
            p2: l2 * (m2 * twice).sqrt(),
            v1,
            v2,
        }
    }
}

impl<R: Real> Modes<R> {
    /// The longest step with which RK4 is stable on the fast mode, s: 2 sqrt(2)/w1 (`[Hairer II]`, section IV.2).
    ///
    /// A limit, not advice: the phase is useless long before it.
    #[must_use]
    pub fn step_limit(&self) -> R {
        R::from_f64(8.0).sqrt() / self.fast.frequency
    }

    /// Refuses a step `dt` (s) that is NaN, infinite, zero, negative, out of the range of `R`, or above
    /// [`step_limit`](Self::step_limit).
    pub fn check_step(&self, dt: f64) -> Result<(), Error> {
        check_forward::<R>(dt)?;
        let limit = self.step_limit().to_f64();
        if dt > limit {
            return Err(Error::TooLarge {
                parameter: Parameter::Dt,
                value: dt,
                limit,
            });
        }
        Ok(())
    }
}

impl<R: Real> Pendulum<R> {
    /// The bounds of the motion through `state`.
    #[must_use]
    pub fn bounds(&self, state: &State<R>) -> Bounds<R> {
        Bounds::new(self.parameters(), self.energy_above_rest(state))
    }

    /// The least energy above rest with which a rod can turn over, J: 2 g min((m1 + m2) l1, m2 l2).
    ///
    /// It is the lower of the two saddles V(pi, 0) and V(0, pi), above min V.
    #[must_use]
    pub fn turnover_energy(&self) -> R {
        let [torque1, torque2] = self.torque;
        R::TWO * if torque1 < torque2 { torque1 } else { torque2 }
    }

    /// Whether it is certain that neither rod ever turns over: K below [`turnover_energy`](Self::turnover_energy).
    ///
    /// `false` says nothing. Energies within 16 roundings of the limit are not certified.
    #[must_use]
    pub fn cannot_turn_over(&self, state: &State<R>) -> bool {
        let margin = R::ONE + R::from_f64(ROUNDING_MARGIN) * R::EPSILON;
        self.energy_above_rest(state) * margin < self.turnover_energy()
    }

    /// As [`Modes::check_step`]; without gravity there are no modes and every step forward is accepted.
    pub fn check_step(&self, dt: f64) -> Result<(), Error> {
        if self.parameters().g == R::ZERO {
            check_forward::<R>(dt)
        } else {
            self.modes()?.check_step(dt)
        }
    }

    /// The fastest rate, 1/s, at which anything changes in a motion of the energy of `state`:
    /// W = sqrt(w1^2 + (1 + m2/m1) d^2), w1 being the fast normal frequency and d [`Bounds::elbow`].
    ///
    /// What the rods do to each other goes with 1/(m1 + m2 sin^2 D), which doubles within sin D = sqrt(m1/m2): an elbow
    /// that bends at the rate d is through a light bob 1's peak in sqrt(m1/m2)/d. Without gravity w1 is 0.
    ///
    /// Refuses parameters whose modes are out of range.
    #[doc(hidden)]
    pub fn fastest_rate(&self, state: &State<R>) -> Result<R, Error> {
        let &Parameters { m1, m2, g, .. } = self.parameters();
        let normal = if g == R::ZERO {
            R::ZERO
        } else {
            self.modes()?.fast.frequency
        };
        let elbow = self.bounds(state).elbow * (R::ONE + m2 / m1).sqrt();
        Ok((normal * normal + elbow * elbow).sqrt())
    }

    /// The longest step, s, with which RK4 resolves every motion of the energy of `state`: 1/(4 W), W being the
    /// [`fastest_rate`](Self::fastest_rate). Infinite where nothing can move.
    ///
    /// Up to it a step errs by at most 3e-5 W dt rad in each angle (0.0072 (W dt)^5, at any masses and lengths),
    /// and by as much of W in each velocity; the direction form by 8e-5. Half the step errs 16 times less.
    /// It is sharp for the motion of that energy with the fastest changes. A regular one, and one with a light bob 2 that never gathers
    /// all of the energy, may do with much longer steps, up to [`Modes::step_limit`].
    ///
    /// ```
    /// use double_pendulum::{Parameters, Pendulum, State};
    ///
    /// let step = |mass_ratio: f64| {
    ///     let pendulum = Pendulum::new(&Parameters::equal_rods(mass_ratio, 1.0, 9.81))?;
    ///     pendulum.admissible_step(&State::at_rest(2.0, 2.0))
    /// };
    /// assert!((1.0 / step(1.0)? - 117.8).abs() < 0.1);
    /// assert!(step(1000.0)? < 1.0 / 50_000.0); // a light elbow snaps through the straight position
    /// # Ok::<(), double_pendulum::Error>(())
    /// ```
    pub fn admissible_step(&self, state: &State<R>) -> Result<R, Error> {
        Ok(R::from_f64(RESOLVED) / self.fastest_rate(state)?)
    }
}

/// W dt of the longest step that resolves a motion whose fastest rate is W.
const RESOLVED: f64 = 0.25;

/// As [`check_step`], and refuses a step backwards.
fn check_forward<R: Real>(dt: f64) -> Result<(), Error> {
    if dt.is_finite() && dt <= 0.0 {
        return Err(Error::NotPositive {
            parameter: Parameter::Dt,
            value: dt,
        });
    }
    check_step::<R>(dt)
}

/// Refuses a step of `dt` s that is NaN, infinite, zero or out of the range of `R`.
#[inline(never)] // one copy
pub(crate) fn check_step<R: Real>(dt: f64) -> Result<(), Error> {
    let (parameter, value) = (Parameter::Dt, dt);
    if !dt.is_finite() {
        Err(Error::NotFinite { parameter, value })
    } else if !R::from_f64(dt).is_normal() {
        Err(Error::OutOfRange { parameter, value })
    } else {
        Ok(())
    }
}

/// How many roundings, relative to K, a certificate keeps clear of its limit: more than the evaluation of K makes
/// when no kinetic term cancels.
const ROUNDING_MARGIN: f64 = 16.0;
