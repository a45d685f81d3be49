//! Step counts, and the steps that resolve a motion.

use super::{Costs, Problem};
use crate::error::Error;
use crate::methods::any::longest_step;
use crate::pendulum::{Pendulum, State};
use crate::table::Method;

/// A method and its number of steps per frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stepping {
    /// The method. Only those in [`Method::DRAWN`] can be run or planned.
    pub method: Method,
    /// The number of steps per frame. A motion or search counts 0 as 1. A motion by the closed
    /// form, which has no steps, ignores it; [`Search::of`](super::Search::of) does not.
    pub steps: u32,
}

/// The longest step in 64 bits, in admissible steps, in which rounding is the larger error, so that
/// shorter ones gain nothing.
const RESOLVING: f64 = 0.7;
/// The longest step in 64 bits that resolves a motion, in admissible steps. The fastest rate that
/// the energy allows advances a phase by a radian in it.
const COARSEST: f64 = 4.0;

/// The longest steps of RK4 that resolve a motion, in admissible steps. In longer ones RK4 gains or
/// loses several percent of the energy within seconds, or diverges.
const OF_RK4: f64 = 2.0;

/// The smallest number of steps per frame that no search tries. A
/// [`Search::of`](super::Search::of) takes any number.
const MOST_STEPS: u32 = 1 << 16;

/// Returns the smallest number of steps per frame that makes steps of at most `longest` s, at
/// `rate` frames per second.
///
/// Except in 64 bits it is a power of two, because steps are usually refined by powers of two. The
/// result is from 1 to [`MOST_STEPS`], 65,536; at the largest number the steps may be longer than
/// `longest`. A `longest` that is infinite, NaN or negative gives 1. Otherwise, a `longest` or a
/// `rate` of 0 gives the largest number.
#[inline(never)] // 3 KB more flash without.
fn steps_to_frame(method: Method, rate: u16, longest: f64) -> u32 {
    let fewest = libm::ceil(1.0 / (longest * f64::from(rate)));
    let fewest = (fewest as u32).clamp(1, MOST_STEPS);
    if method == Method::Extrapolation10Fixed64 {
        fewest
    } else {
        fewest.next_power_of_two()
    }
}

/// The start of a problem, and the longest steps of its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steps {
    pub start: State<f64>,
    /// The longest step that resolves every motion of the same energy, s: the
    /// [admissible step](Pendulum::admissible_step).
    pub admissible: f64,
    /// The longest steps that the methods accept, s, in fixed point of 32 bits, of 64 bits, and in
    /// `f32`; `None` if they refuse the motion.
    in_32_bits: Option<f64>,
    in_64_bits: Option<f64>,
    in_floats: Option<f64>,
    rate: u16,
}

impl Steps {
    /// Returns the steps of the motion of `problem`.
    ///
    /// # Errors
    ///
    /// Refuses the inputs that [`Pendulum::new`] and [`Pendulum::admissible_step`] refuse.
    pub fn of(problem: &Problem) -> Result<Self, Error> {
        let pendulum = Pendulum::new(&problem.pendulum)?;
        let start = pendulum.to_state(&problem.start);
        let energy = pendulum.energy_above_rest(&start);
        let longest = |method| longest_step(method, &problem.pendulum, energy).ok();
        Ok(Self {
            start,
            admissible: pendulum.admissible_step(&start)?,
            in_32_bits: longest(Method::Rk4Fixed32),
            in_64_bits: longest(Method::Extrapolation10Fixed64),
            in_floats: longest(Method::Rk4F32Direction),
            rate: problem.rate,
        })
    }

    /// Returns `method` with `steps` steps per frame, or with more if it refuses these as too long.
    ///
    /// Returns `None` if the method refuses the motion for another reason, or if the step count
    /// reaches [`MOST_STEPS`].
    fn accepted(&self, method: Method, steps: u32) -> Option<Stepping> {
        let longest = match method {
            Method::Rk4Fixed32 => self.in_32_bits?,
            Method::Extrapolation10Fixed64 => self.in_64_bits?,
            _ => self.in_floats?,
        };
        let enough = steps_to_frame(method, self.rate, longest).max(steps);
        let mut stepping = Stepping {
            method,
            steps: enough,
        };
        // Rounding may have hidden that one more is needed.
        if stepping.dt(self.rate) > longest {
            let shorter = longest * (1.0 - 4.0 * f64::EPSILON);
            stepping.steps = steps_to_frame(method, self.rate, shorter);
        }
        (stepping.steps < MOST_STEPS).then_some(stepping)
    }

    /// Returns the steps in 64 bits in which rounding is the larger error, or `most` per frame if
    /// that is less, but at least as many as resolve the motion. `None` if the method refuses it.
    pub fn in_64_bits(&self, most: u32) -> Option<Stepping> {
        let method = Method::Extrapolation10Fixed64;
        let of = |longest| steps_to_frame(method, self.rate, longest * self.admissible);
        self.accepted(method, of(RESOLVING).min(most).max(of(COARSEST)))
    }

    /// Returns RK4 in the coarsest steps that resolve the motion, by the method in 32 bits that then
    /// costs less. `None` if both refuse the motion.
    pub fn of_rk4(&self, costs: &Costs) -> Option<Stepping> {
        let accepted = |method| {
            let steps = steps_to_frame(method, self.rate, OF_RK4 * self.admissible);
            self.accepted(method, steps)
        };
        [Method::Rk4Fixed32, Method::Rk4F32Direction]
            .into_iter()
            .filter_map(accepted)
            .min_by(|a, b| f32::total_cmp(&costs.of_frame(*a), &costs.of_frame(*b)))
    }

    /// Returns the method and step count to start with, as [`Stepping::initial`] does. `costs` are
    /// those for the pendulum.
    pub fn initial(&self, costs: &Costs, frame: f32) -> Option<Stepping> {
        let is_affordable = |stepping: &Stepping| costs.of_frame(*stepping) <= frame;
        let most = (frame / costs.fixed64) as u32;
        let in_64_bits = self.in_64_bits(most).filter(is_affordable);
        let of_rk4 = || {
            let coarse = self.of_rk4(costs)?;
            let fine = Stepping {
                steps: 2 * coarse.steps,
                ..coarse
            };
            [fine, coarse].into_iter().find(is_affordable)
        };
        in_64_bits.or_else(of_rk4)
    }
}

impl Stepping {
    /// Returns the length of a step at `rate` frames per second, s.
    pub(super) fn dt(self, rate: u16) -> f64 {
        1.0 / (f64::from(rate) * f64::from(self.steps))
    }

    /// Returns the method and step count to start with, before planning has produced a result.
    ///
    /// They are the first of the following whose frame costs at most `frame`:
    ///
    /// 1. [`Method::Extrapolation10Fixed64`] in steps of 0.7 [admissible
    ///    steps](Pendulum::admissible_step), or in the shortest ones that a frame can pay for, if
    ///    they are at most 4 admissible steps long;
    /// 2. RK4 in admissible steps, by [`Method::Rk4Fixed32`] or [`Method::Rk4F32Direction`],
    ///    whichever costs less;
    /// 3. the same in twice as long steps. Longer ones gain or lose several percent of the energy
    ///    within seconds.
    ///
    /// These lengths are upper limits. The step count is rounded up, for RK4 to a power of two, and
    /// increased if the method refuses the steps as too long. It is 1 if nothing can move.
    ///
    /// `frame` is the frame budget in the unit of `costs`. Neither is checked. The tolerance and the
    /// duration are not used. Returns `None` if a frame pays for none of these, if they take 65,536
    /// steps per frame or more, or if the methods refuse the motion.
    ///
    /// # Errors
    ///
    /// Refuses a pendulum that [`Pendulum::new`] or [`Pendulum::admissible_step`] refuses: with
    /// masses or lengths that are not finite or not positive, with a gravity that is not finite or
    /// negative, or with numbers out of range.
    pub fn initial(problem: &Problem, costs: &Costs, frame: f32) -> Result<Option<Self>, Error> {
        let costs = costs.for_pendulum(&problem.pendulum);
        Ok(Steps::of(problem)?.initial(&costs, frame))
    }

    /// Returns `method` with the fewest steps per frame whose length is at most 4 [admissible
    /// steps](Pendulum::admissible_step), or 0.7 by [`Method::Extrapolation10Fixed64`]. By the
    /// other methods, even by the closed form, which ignores it, the count is a power of two. If
    /// the method refuses the steps as too long, it gets more, until it accepts them. The cost of a
    /// frame does not matter.
    ///
    /// If the method refuses the motion itself, is not in [`Method::DRAWN`], or accepts no step
    /// count below 65,536, the result is not checked: it has the first step count, which is 65,536
    /// for a rate of 0. Only [`PlannedRun::new`] then shows whether the method refuses it.
    ///
    /// [`PlannedRun::new`]: super::PlannedRun::new
    ///
    /// # Errors
    ///
    /// Refuses what [`initial`](Self::initial) refuses.
    pub fn of(problem: &Problem, method: Method) -> Result<Self, Error> {
        let motion = Steps::of(problem)?;
        let longest = if method == Method::Extrapolation10Fixed64 {
            RESOLVING
        } else {
            COARSEST
        };

        let steps = steps_to_frame(method, problem.rate, longest * motion.admissible);
        let accepted = motion.accepted(method, steps);
        Ok(accepted.unwrap_or(Self { method, steps }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pendulum::{Motion, Parameters};
    use crate::plan::PlannedRun;

    /// Returns the least gravity, m/s^2, for which the method refuses the step as too long. `under`
    /// returns a problem with a given gravity.
    fn refused_gravity(stepping: Stepping, under: impl Fn(f64) -> Problem) -> f64 {
        let [mut accepted, mut refused] = [1e-3, 1e6];
        loop {
            let middle = 0.5 * (accepted + refused);
            if middle <= accepted || middle >= refused {
                return refused;
            }
            match PlannedRun::new(&under(middle), stepping) {
                Ok(_) => accepted = middle,
                Err(_) => refused = middle,
            }
        }
    }

    fn accepted(problem: &Problem, stepping: Stepping) -> Option<Stepping> {
        let motion = Steps::of(problem).expect("a pendulum");
        motion.accepted(stepping.method, stepping.steps)
    }

    /// Gravity is so strong that a step is just refused as too long. Then one more step per frame
    /// is accepted in 64 bits, and twice as many in fixed point of 32 bits.
    ///
    /// The error names a limit that equals the refused step within rounding errors. For 15 and 30
    /// steps in 64 bits, that limit alone would give the refused step count again. A step count of
    /// 65,536 ([`MOST_STEPS`]) is never a result.
    #[test]
    fn steps_are_increased_at_the_edge_of_their_limit() {
        let under = |g| Problem {
            pendulum: Parameters::equal_rods(1.0, 1.0, g),
            start: Motion::at_rest(1e-6, 1e-6),
            tolerance: 0.01,
            duration: 1.0,
            rate: 7,
        };
        for (method, steps, more) in [
            (Method::Extrapolation10Fixed64, 8, 9),
            (Method::Extrapolation10Fixed64, 15, 16),
            (Method::Extrapolation10Fixed64, 30, 31),
            (Method::Rk4Fixed32, 1, 2),
            (Method::Rk4Fixed32, 8, 16),
        ] {
            let edge = under(refused_gravity(Stepping { method, steps }, under));
            let accepted = accepted(&edge, Stepping { method, steps });
            let expected = Stepping {
                method,
                steps: more,
            };
            assert_eq!(accepted, Some(expected), "{method}, {steps}");
        }

        // The method accepts 65,536 steps, but they are too many.
        let method = Method::Rk4Fixed32;
        let steps = MOST_STEPS;
        let stepping = Stepping { method, steps };
        assert!(PlannedRun::new(&under(1.0), stepping).is_ok());
        assert_eq!(accepted(&under(1.0), stepping), None);
    }
}
