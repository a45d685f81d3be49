//! Bounds that follow from the energy of a motion, and the step sizes that follow from the bounds.

use crate::error::{Error, Parameter};
use crate::numbers::{Real, RealOperations};
use crate::pendulum::{Parameters, Pendulum, State};
use crate::small::Modes;

/// The largest magnitudes that a motion of a given energy can reach.
///
/// Each is reached by some motion of that energy. K is the energy above hanging at rest, J. The
/// bounds follow from T <= K, T >= m1 v1^2/2 and T >= m2 v2^2/2, and from completing squares in T
/// for each w and p alone. They are exact up to the rounding of K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<R> {
    /// |w1| <= sqrt(2 K/m1)/l1, rad/s.
    pub w1: R,
    /// |w2| <= sqrt(2 K (m1 + m2)/(m1 m2))/l2, rad/s.
    pub w2: R,
    /// |w1 - w2| <= sqrt(2 K (l1^2/m2 + (l1 + l2)^2/m1))/(l1 l2), rad/s. This is the rate of the
    /// elbow's angle and the largest of the three rates.
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
    /// Returns the bounds for K = `energy_above_rest`, J.
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
    /// Returns the longest stable step of RK4 on the fast mode, s: 2 sqrt(2)/w1 (`[Hairer II]`,
    /// section IV.2). Much shorter steps already give a wrong phase.
    #[must_use]
    pub fn step_limit(&self) -> R {
        R::from_f64(8.0).sqrt() / self.fast.frequency
    }

    /// Refuses a step `dt` (s) that is NaN or infinite ([`Error::NotFinite`]), zero or negative
    /// ([`Error::NotPositive`]), zero, subnormal or infinite in `R` ([`Error::OutOfRange`]), or
    /// longer than [`step_limit`](Self::step_limit) ([`Error::TooLarge`]). For a step backwards,
    /// check its magnitude.
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
    /// Returns the bounds of the motion through `state`, forwards and backwards in time. Velocities
    /// below 1e-140 rad/s count as 0. A state that is not finite, or whose energy overflows in
    /// `f64`, gives bounds that are NaN or infinite.
    #[must_use]
    pub fn bounds(&self, state: &State<R>) -> Bounds<R> {
        let Bounds {
            w1,
            w2,
            elbow,
            p1,
            p2,
            v1,
            v2,
        } = self.bounds_in_f64(state);
        Bounds {
            w1: w1.cast(),
            w2: w2.cast(),
            elbow: elbow.cast(),
            p1: p1.cast(),
            p2: p2.cast(),
            v1: v1.cast(),
            v2: v2.cast(),
        }
    }

    /// Returns the [`bounds`](Self::bounds), in whose squares an `f32` would overflow or underflow.
    fn bounds_in_f64(&self, state: &State<R>) -> Bounds<f64> {
        let parameters = self.parameters().cast::<f64>();
        let pendulum = Pendulum::unchecked(&parameters);
        Bounds::new(&parameters, pendulum.energy_above_rest(&state.cast()))
    }

    /// Returns the least energy above rest that allows a rod to turn over, J: 2 g min((m1 + m2) l1,
    /// m2 l2).
    ///
    /// It is the height of the lower of the two saddles V(pi, 0) and V(0, pi) above min V.
    #[must_use]
    pub fn turnover_energy(&self) -> R {
        let [torque1, torque2] = self.torque;
        R::TWO * if torque1 < torque2 { torque1 } else { torque2 }
    }

    /// Returns true if neither rod can ever turn over: if K is below
    /// [`turnover_energy`](Self::turnover_energy).
    ///
    /// `false` means that a rod may turn over or not; it is also the result within 16 epsilons of
    /// `R` below the limit, and for a state that is not finite.
    ///
    /// `true` is certain for a state at rest. With momenta and a heavy bob 2, terms of the kinetic
    /// energy can cancel: the result can be `true` for a K that exceeds the limit by the share
    /// epsilon sqrt(1 + m2/m1), for m2/m1 = 10,000 by 1e-5 in `f32`.
    #[must_use]
    pub fn cannot_turn_over(&self, state: &State<R>) -> bool {
        let margin = R::ONE + R::from_f64(ROUNDING_MARGIN) * R::EPSILON;
        self.energy_above_rest(state) * margin < self.turnover_energy()
    }

    /// Refuses the steps `dt` (s) that [`Modes::check_step`] refuses. Without gravity, where no
    /// modes exist, there is no longest step. With gravity, parameters whose modes are out of range
    /// are refused first ([`Error::OutOfRange`]).
    pub fn check_step(&self, dt: f64) -> Result<(), Error> {
        if self.parameters().g == R::ZERO {
            check_forward::<R>(dt)
        } else {
            self.modes()?.check_step(dt)
        }
    }

    /// Returns the rate W of [`admissible_step`](Self::admissible_step), 1/s.
    ///
    /// The forces between the rods contain 1/(m1 + m2 sin^2 D), which doubles within sin D =
    /// sqrt(m1/m2). An elbow with the rate d passes this peak in sqrt(m1/m2)/d.
    fn fastest_rate(&self, state: &State<R>) -> Result<f64, Error> {
        let parameters = self.parameters().cast::<f64>();
        let normal = if parameters.g == 0.0 {
            0.0
        } else {
            Modes::new(&parameters)?.fast.frequency
        };
        let peak = libm::sqrt(1.0 + parameters.m2 / parameters.m1);
        let elbow = self.bounds_in_f64(state).elbow * peak;
        Ok(libm::sqrt(normal * normal + elbow * elbow))
    }

    /// Returns the longest step, s, that resolves every motion with the energy of `state` by RK4:
    /// 1/(4 W). It is infinite if nothing can move: at rest without gravity.
    ///
    /// W = sqrt(w1^2 + (1 + m2/m1) d^2) is the fastest rate of change, 1/s, of any quantity in such
    /// a motion. Here w1 is the fast normal frequency (0 without gravity) and d is
    /// [`Bounds::elbow`].
    ///
    /// One such step has an error of at most 7.5e-6 rad in each angle and 7.5e-6 W in each
    /// velocity, for any masses and lengths; in the direction form 2e-5 rad and 2e-5 W. Each error
    /// is proportional to dt^5.
    ///
    /// Much longer steps, up to [`Modes::step_limit`], can be sufficient for regular motions, and
    /// for a light bob 2 that never has all the energy.
    ///
    /// ```
    /// use double_pendulum::{Parameters, Pendulum, State};
    ///
    /// let step = |mass_ratio: f64| {
    ///     let pendulum = Pendulum::new(&Parameters::equal_rods(mass_ratio, 1.0, 9.81))?;
    ///     pendulum.admissible_step(&State::at_rest(2.0, 2.0))
    /// };
    /// assert!((1.0 / step(1.0)? - 117.8).abs() < 0.1);
    /// assert!(step(1000.0)? < 1.0 / 50_000.0); // A light elbow snaps through.
    /// # Ok::<(), double_pendulum::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Refuses parameters whose modes are out of range ([`Error::OutOfRange`]). The state is not
    /// checked; one that is not finite, or whose bounds overflow, gives NaN or 0.
    pub fn admissible_step(&self, state: &State<R>) -> Result<R, Error> {
        Ok(R::from_f64(RESOLVED / self.fastest_rate(state)?))
    }
}

/// The product W dt for the longest step that resolves a motion whose fastest rate is W.
const RESOLVED: f64 = 0.25;

/// The largest stable phase w1 dt of RK4 on the fast mode, rad: 2 sqrt(2).
pub(crate) const RK4_STABLE: f64 = 2.828_427_124_746_190_3;

/// Returns the longest step, s, whose phase of the fast mode is at most `phase` rad; infinite if
/// the pendulum has no modes.
pub(crate) fn stable_step(parameters: &Parameters<f64>, phase: f64) -> f64 {
    Modes::new(parameters).map_or(f64::INFINITY, |modes| phase / modes.fast.frequency)
}

fn check_forward<R: Real>(dt: f64) -> Result<(), Error> {
    if dt.is_finite() && dt <= 0.0 {
        return Err(Error::NotPositive {
            parameter: Parameter::Dt,
            value: dt,
        });
    }
    check_step::<R>(dt)
}

/// Refuses a step of `dt` s, forwards or backwards, that the numbers `R` cannot hold.
pub(crate) fn check_step<R: Real>(dt: f64) -> Result<(), Error> {
    let parameter = Parameter::Dt;
    let value = dt;
    if !dt.is_finite() {
        Err(Error::NotFinite { parameter, value })
    } else if !R::from_f64(dt).is_normal() {
        Err(Error::OutOfRange { parameter, value })
    } else {
        Ok(())
    }
}

/// The number of roundings of K within which `cannot_turn_over` gives no certificate. It exceeds
/// the rounding error of K if no kinetic term cancels, as for a state at rest.
const ROUNDING_MARGIN: f64 = 16.0;
