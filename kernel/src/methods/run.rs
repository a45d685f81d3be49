//! Motions in progress, with checks and, on request, with a count of whole turns.

use super::{Fixed32, Form, Turns};
use crate::bounds::stable_step;
use crate::error::{Error, Parameter};
use crate::numbers::{Real, RealOperations};
use crate::pendulum::{Direction, Parameters, Pendulum, State};

/// A motion in progress by the method `F`. [`Pendulum::run`] returns it.
///
/// It takes a few hundred bytes and no heap.
///
/// # Whole turns
///
/// The methods that carry directions do not know how often a rod has turned over. Their angles are
/// in [-pi, pi], unless the turns are counted: [`counting_turns`] returns a `Run<F, true>`, which
/// observes the directions after every step. On a Cortex-M4F this nearly
/// doubles the cost of a step. A drawing needs no turns.
///
/// [`HamiltonF32`](crate::HamiltonF32), [`HamiltonF64`](crate::HamiltonF64) and the closed form
/// carry angles, which always include whole turns.
///
/// [`counting_turns`]: Run::counting_turns
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run<F: Form, const COUNTS_TURNS: bool = false> {
    pendulum: Pendulum<F::Real>,
    /// The energy H above which the motion counts as diverged. Unused if `F` checks its energy.
    most_energy: F::Real,
    motion: F,
    /// The turns at the start. If turns are counted, it is updated after every step.
    turns: [Turns; 2],
    dt: f64,
    steps: u64,
}

impl<R: Real> Pendulum<R> {
    /// Returns the motion from `start` in steps of `dt` seconds by the method `F`.
    ///
    /// A negative `dt` runs backwards. The pendulum and the start are rounded to the numbers of the
    /// method. Only the code of the method `F` is linked.
    ///
    /// # Errors
    ///
    /// Refuses:
    ///
    /// - a step that is NaN or infinite, by [`Error::NotFinite`], or, by [`Error::OutOfRange`],
    ///   zero, subnormal or too large in the method's numbers (`f64` for fixed point and the closed
    ///   form), or so short that a torque of gravity in a step is;
    /// - a start that is not finite, by [`Error::NotFinite`];
    /// - a start of 2^31 - 1 turns or more, or, for the closed form, one from which an angle may
    ///   exceed them, by [`Error::OutOfRange`]; methods in angles accept any;
    /// - a pendulum or a start out of the range of the method's numbers, by [`Error::OutOfRange`];
    ///   if one of its numbers becomes infinite there, by [`Error::NotFinite`], or a mass or length
    ///   zero, by [`Error::NotPositive`];
    /// - for the closed form, a pendulum without gravity, by [`Error::NotPositive`];
    /// - a step beyond the limit of stability of the fast mode, of frequency w1, or beyond that of
    ///   [`Fixed32`] or [`Fixed64`](crate::Fixed64): [`Error::TooLarge`] contains the largest
    ///   magnitude, s. The closed form has no such limit.
    ///
    /// The limit of RK4 is w1 dt = 2.83 ([`check_step`](Self::check_step)). Extrapolation of the
    /// orders 2, 4 .. 16 is stable, or lets the mode grow by less than a tenth in a step, up to w1
    /// dt = 0.95, 2.86, 2.51, 3.67, 5.28, 4.77, 6.37 and 7.35.
    ///
    /// A fast motion may need far shorter steps: [`admissible_step`](Self::admissible_step)
    /// resolves every motion of an energy.
    pub fn run<F: Form>(&self, start: &State<R>, dt: f64) -> Result<Run<F>, Error> {
        let parameters = self.parameters().cast();
        let motion: F = start_within(&parameters, &start.cast(), dt)?;
        let angles = if motion.has_turns() {
            [0.0; 2]
        } else {
            start.angles().map(R::to_f64)
        };
        let turns = Turns::of(angles, motion.sides())?;

        let pendulum = Pendulum::new(&parameters.cast())?;
        let most_energy = if F::CHECKS_ENERGY {
            F::Real::ZERO
        } else {
            let energy = Pendulum::new(&parameters)?.energy_above_rest(&start.cast());
            F::Real::from_f64(ENERGY_GROWTH * energy)
        };
        Ok(Run {
            pendulum,
            most_energy,
            motion,
            turns,
            dt,
            steps: 0,
        })
    }
}

/// Prepares the motion. Refuses a step beyond the limit of stability or of the method's numbers;
/// the error contains the smaller of both limits, whichever refuses the step.
fn start_within<F: Form>(
    parameters: &Parameters<f64>,
    start: &State<f64>,
    dt: f64,
) -> Result<F, Error> {
    let stable = stable_step(parameters, F::STABLE);
    let is_too_long = libm::fabs(dt) > stable;
    let too_large = |limit: f64| Error::TooLarge {
        parameter: Parameter::Dt,
        value: dt,
        limit: libm::fmin(limit, stable),
    };

    match F::new(parameters, start, dt) {
        Ok(_) if is_too_long => Err(too_large(stable)),
        Err(Error::TooLarge {
            parameter: Parameter::Dt,
            limit,
            ..
        }) => Err(too_large(limit)),
        // The constants or momenta are in proportion to the step, and so may overflow by it.
        Err(Error::OutOfRange {
            parameter: Parameter::Dt | Parameter::P1 | Parameter::P2,
            ..
        }) if is_too_long && F::Real::from_f64(dt).is_finite() => Err(too_large(stable)),
        started => started,
    }
}

/// The energy H above which a motion counts as diverged, divided by the energy above rest of the
/// start. H is zero for horizontal rods at rest, so that the energy above rest may reach a hundred
/// times that of the start, plus the energy of lifting both bobs to the pivot.
const ENERGY_GROWTH: f64 = 100.0;

impl<F: Form> Run<F> {
    /// Returns the same motion with a count of whole turns, for [`angles`](Self::angles) and
    /// [`state`](Self::state).
    ///
    /// Call it before the first step, and the turns of the start are included. Later, the count
    /// begins at angles in [-pi, pi]. A step must not turn a rod by more than a quarter turn,
    /// otherwise whole turns are miscounted; this is not checked.
    ///
    /// ```
    /// use double_pendulum::{DirectionF32, Parameters, Pendulum, State};
    ///
    /// let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 1.0, 9.81))?;
    /// let start = State::at_rest(7.0, 0.5);
    /// let run = pendulum.run::<DirectionF32>(&start, 1.0 / 240.0)?;
    /// assert!((run.angles()[0] - (7.0 - core::f32::consts::TAU)).abs() < 1e-6);
    /// assert!((run.counting_turns().angles()[0] - 7.0).abs() < 1e-6);
    /// # Ok::<(), double_pendulum::Error>(())
    /// ```
    #[must_use]
    pub fn counting_turns(self) -> Run<F, true> {
        // The whole turns are known only at the start; later only the directions are.
        let turns = if self.steps == 0 {
            self.turns
        } else {
            Turns::within_half_a_turn(self.motion.sides())
        };
        Run {
            pendulum: self.pendulum,
            most_energy: self.most_energy,
            motion: self.motion,
            turns,
            dt: self.dt,
            steps: self.steps,
        }
    }
}

impl<F: Form, const COUNTS_TURNS: bool> Run<F, COUNTS_TURNS> {
    fn observes(&self) -> bool {
        COUNTS_TURNS && !self.motion.has_turns()
    }

    /// Advances the motion by `steps` steps. `advance(a); advance(b)` is bit-identical to
    /// `advance(a + b)`, if no call returns an error.
    ///
    /// # Errors
    ///
    /// Returns [`Error::Diverged`], and leaves the run unchanged, if the steps have led to:
    ///
    /// - numbers that are not finite or, in fixed point, out of range;
    /// - directions shorter than 1/2 or longer than 2;
    /// - an energy far above the initial one, because the step was too long for the motion.
    ///
    /// The limit on the energy above rest is 100 times its initial value, plus (m1 + m2) g l1 + m2
    /// g l2. Energy and lengths are checked once at the end of each call, so that one long call may
    /// accept a motion that several short calls refuse.
    ///
    /// The limit of [`Fixed32`] is 9/8 of the initial value, plus an allowance for rounding, and is
    /// checked after every 32 steps since the start. [`Fixed64`](crate::Fixed64) checks the range
    /// of its numbers instead, after every step. The closed form has no such limit.
    pub fn advance(&mut self, steps: u32) -> Result<(), Error> {
        let Self {
            mut motion,
            mut turns,
            ..
        } = *self;
        if self.observes() {
            for _ in 0..steps {
                motion.advance(1);
                Turns::observe(&mut turns, motion.sides());
            }
        } else {
            motion.advance(steps);
        }

        motion.check()?;
        if !F::CHECKS_ENERGY {
            self.check_energy(&motion)?;
        }
        self.motion = motion;
        self.turns = turns;
        self.steps += u64::from(steps);
        Ok(())
    }

    fn check_energy(&self, motion: &F) -> Result<(), Error> {
        let directions = motion.directions();
        let [shortest, longest] = [0.25, 4.0].map(F::Real::from_f64);
        for (parameter, [s, c]) in [Parameter::A1, Parameter::A2].into_iter().zip(directions) {
            let square = s * s + c * c;
            if !(shortest..=longest).contains(&square) {
                let value = square.sqrt().to_f64();
                return Err(Error::Diverged { parameter, value });
            }
        }

        let energy = self.pendulum.energy_at(directions, motion.momenta_nearly());
        let is_bounded = energy <= self.most_energy; // false if it is NaN
        if self.most_energy.is_finite() && !is_bounded {
            return Err(Error::Diverged {
                parameter: Parameter::Energy,
                value: energy.to_f64(),
            });
        }
        Ok(())
    }

    /// Returns the directions of rod 1 and rod 2, (sin, cos) each. A drawing needs no more.
    ///
    /// Their length is 1, except for the errors of the method, which reach 4e-4 by the closed form.
    /// In the direction form in floating point they may be up to half a step ahead of the
    /// [`state`](Self::state) or behind it. After an error they are those before the call.
    #[must_use]
    pub fn directions(&self) -> [Direction<F::Real>; 2] {
        self.motion.directions()
    }

    /// Returns the angles a1 and a2, rad, at the time of the [`directions`](Self::directions), at
    /// the cost of two arc tangents, unless the method carries angles.
    ///
    /// They are within [-pi, pi], unless [whole turns](Self#whole-turns) are counted or carried.
    #[must_use]
    pub fn angles(&self) -> [F::Real; 2] {
        if self.motion.has_turns() {
            return self.state().cast().angles();
        }

        let directions = self.directions();
        if self.observes() {
            let [direction1, direction2] = directions;
            let [turns1, turns2] = &self.turns;
            [turns1.angle(direction1), turns2.angle(direction2)]
        } else {
            directions.map(|[s, c]| s.atan2(c))
        }
    }

    /// Returns the canonical state in SI units, with all digits that the method carries.
    ///
    /// The angles are within [-pi, pi], unless [whole turns](Self#whole-turns) are counted or
    /// carried.
    ///
    /// The state is that at the number of steps times dt, even if the motion itself is ahead of
    /// that time or behind it ([`Form`]). Taking the difference back changes the energy by at most
    /// 1e-4 of the energy above rest if w1 dt is 0.2 or less, where w1 is the frequency of the fast
    /// mode (asserted over a day of regular motion).
    #[must_use]
    pub fn state(&self) -> State<f64> {
        let state = self.motion.state();
        if self.observes() {
            Turns::unwrap(&self.turns, state)
        } else {
            state
        }
    }

    /// Returns the energy H, J, at the time of the [`directions`](Self::directions)
    /// ([`Pendulum::energy`]).
    #[must_use]
    pub fn energy(&self) -> F::Real {
        self.pendulum
            .energy_at(self.directions(), self.motion.momenta())
    }

    /// Passes the words of [`bits`](crate::methods::FormOperations::bits) to `feed`, without the
    /// count of turns.
    pub(crate) fn bits(&self, feed: impl FnMut(u64)) {
        self.motion.bits(feed);
    }

    #[cfg(test)]
    pub(crate) fn motion(&self) -> &F {
        &self.motion
    }

    /// Returns the time since the start, s: the number of steps times dt, negative if the motion
    /// runs backwards.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.dt
    }
}

impl<const COUNTS_TURNS: bool> Run<Fixed32, COUNTS_TURNS> {
    /// Returns the directions of rod 1 and rod 2, (sin, cos) each times 2^30.
    ///
    /// They are off from the numbers that the method carries by at most 1 unit of the result for
    /// rod 1, and for rod 2 by 10 units for equal rods (1e-8) and 25 for any rods (a unit test
    /// asserts this).
    ///
    /// They are computed in integers only, as are the steps: a loop of both links no software
    /// floating point.
    #[must_use]
    pub fn directions_q30(&self) -> [Direction<i32>; 2] {
        self.motion.q30()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::DirectionF32;
    use crate::pendulum::Motion;

    #[test]
    fn most_energy_is_in_proportion_to_that_of_the_start() -> Result<(), Error> {
        let pendulum = Pendulum::<f64>::new(&Parameters::equal_rods(1.0, 1.0, 9.81))?;
        for w1 in [0.01, 1.0, 50.0] {
            let start = pendulum.to_state(&Motion {
                w1,
                ..Motion::default()
            });
            let run = pendulum.run::<DirectionF32>(&start, 1e-3)?;
            let share = f64::from(run.most_energy) / pendulum.energy_above_rest(&start);
            assert!((share / 100.0 - 1.0).abs() < 1e-6, "{w1}: {share}");
        }
        Ok(())
    }
}
