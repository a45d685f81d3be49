//! Costs, budgets, and the step counts that a frame can pay for.

use super::{PlannedRun, Problem};
use crate::error::{Error, Parameter};
use crate::methods::Fixed32;
use crate::pendulum::{Parameters, Pendulum};
use crate::table::Method;

/// The price list of a processor: the cost of a step by each method of [`Method::DRAWN`], and of a
/// frame by the closed form. A step by [`Method::Rk4Fixed32`] has two prices;
/// [`for_pendulum`](Self::for_pendulum) selects the right one.
///
/// The unit is arbitrary, usually cycles; the [`Budget`] has the same unit. Every price must be
/// finite and more than 0, otherwise a search is refused. The lists of some processors are
/// [`CORTEX_M3`](Self::CORTEX_M3), [`CORTEX_M4F`](Self::CORTEX_M4F) and
/// [`CORTEX_M0PLUS`](Self::CORTEX_M0PLUS); that of another one begins with [`Costs::all`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive] // A new drawn method adds a price.
pub struct Costs {
    /// A frame by [`Method::ClosedFormF32`].
    pub closed_form: f32,
    /// A step by [`Method::Rk4F32DirectionPlain`].
    pub direction_plain: f32,
    /// A step by [`Method::Rk4F32Direction`].
    pub direction: f32,
    /// A step by [`Method::Rk4Fixed32`] for rods and masses that are about equal
    /// ([`Fixed32`](crate::Fixed32#cost)).
    pub fixed32: f32,
    /// A step by [`Method::Rk4Fixed32`] for other rods and masses.
    pub fixed32_unlike: f32,
    /// A step by [`Method::Extrapolation10Fixed64`].
    pub fixed64: f32,
    /// The preparation of a motion by any of these methods, or the restart of all shadows of a
    /// search, whichever costs more. Shadows are five motions in 32 bits that measure how the
    /// rounding errors of a run in 64 bits grow.
    pub preparation: f32,
}

impl Costs {
    /// Returns a list in which everything costs `price`, for prices of your own. With a `price`
    /// above the budget of a frame, a method without a price of its own is not chosen.
    ///
    /// On your chip, time [`PlannedRun::advance`] for a step, and [`PlannedRun::new`] for the
    /// preparation.
    ///
    /// ```
    /// use double_pendulum::plan::Costs;
    ///
    /// let mut costs = Costs::all(1e9); // More than a frame may cost.
    /// costs.direction = 250.0;
    /// costs.fixed64 = 14_000.0;
    /// costs.preparation = 160_000.0;
    /// ```
    #[must_use]
    pub const fn all(price: f32) -> Self {
        Self {
            closed_form: price,
            direction_plain: price,
            direction: price,
            fixed32: price,
            fixed32_unlike: price,
            fixed64: price,
            preparation: price,
        }
    }

    /// Returns the price list for this pendulum: [`fixed32`](Self::fixed32) becomes
    /// [`fixed32_unlike`](Self::fixed32_unlike) if rods or masses are not about equal. A search
    /// does this itself.
    #[must_use]
    pub fn for_pendulum(self, parameters: &Parameters<f64>) -> Self {
        let fixed32 = if Fixed32::needs_shifts(parameters) {
            self.fixed32_unlike
        } else {
            self.fixed32
        };
        Self { fixed32, ..self }
    }

    /// Returns the cost of a step by `method`, or of a frame by the closed form. Returns `None` for
    /// a method that is not in [`Method::DRAWN`].
    pub(crate) const fn step(&self, method: Method) -> Option<f32> {
        Some(match method {
            Method::ClosedFormF32 => self.closed_form,
            Method::Rk4F32DirectionPlain => self.direction_plain,
            Method::Rk4F32Direction => self.direction,
            Method::Rk4Fixed32 => self.fixed32,
            Method::Extrapolation10Fixed64 => self.fixed64,
            _ => return None,
        })
    }

    /// Returns the cost of a single step of this method.
    pub(super) fn of_step(&self, stepping: Stepping) -> f32 {
        self.of_frame(Stepping {
            steps: 1,
            ..stepping
        })
    }

    /// Returns the cost of a frame by this method and step count, in the unit of the prices.
    ///
    /// At any step count it is infinite for a method that is not in [`Method::DRAWN`], and
    /// [`closed_form`](Self::closed_form) for the closed form. By the other methods a step count of
    /// 0 costs 0, although a motion counts it as 1. The prices are not checked. For unlike rods or
    /// masses the list must be that [for the pendulum](Self::for_pendulum).
    #[must_use]
    pub fn of_frame(&self, Stepping { method, steps }: Stepping) -> f32 {
        let steps = if method == Method::ClosedFormF32 {
            1
        } else {
            steps
        };
        match self.step(method) {
            Some(step) => step * steps as f32,
            None => f32::INFINITY,
        }
    }
}

// Each method for drawing has a price.
const _: () = {
    let mut i = 0;
    while i < Method::DRAWN.len() {
        let price = Costs::CORTEX_M3.step(Method::DRAWN[i]);
        assert!(price.is_some(), "a method of DrawnMotion has no price");
        i += 1;
    }
};

/// The largest costs that are allowed, in the unit of the [`Costs`]. Both must be finite and more
/// than 0, otherwise a search is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// The largest cost of computing a frame, without drawing it.
    pub frame: f32,
    /// The largest cost of all pieces of a search together.
    pub planning: f32,
}

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
pub(super) const RESOLVING: f64 = 0.7;
/// The longest step in 64 bits that resolves a motion, in admissible steps. The fastest rate that
/// the energy allows advances a phase by a radian in it.
pub(super) const COARSEST: f64 = 4.0;

/// The longest steps of RK4 that resolve a motion, in admissible steps. In longer ones RK4 gains or
/// loses several percent of the energy within seconds, or diverges.
pub(super) const OF_RK4: f64 = 2.0;

/// The smallest number of steps per frame that no search tries. A
/// [`Search::of`](super::Search::of) takes any number.
pub(super) const MOST_STEPS: u32 = 1 << 16;

/// Returns the smallest number of steps per frame that makes steps of at most `longest` s, at
/// `rate` frames per second.
///
/// Except in 64 bits it is a power of two, because steps are usually refined by powers of two. The
/// result is from 1 to [`MOST_STEPS`], 65,536; at the largest number the steps may be longer than
/// `longest`. A `longest` that is infinite, NaN or negative gives 1. Otherwise, a `longest` or a
/// `rate` of 0 gives the largest number.
#[inline(never)] // 3 KB more flash without.
pub(super) fn steps_to_frame(method: Method, rate: u16, longest: f64) -> u32 {
    let fewest = libm::ceil(1.0 / (longest * f64::from(rate)));
    let fewest = (fewest as u32).clamp(1, MOST_STEPS);
    if method == Method::Extrapolation10Fixed64 {
        fewest
    } else {
        fewest.next_power_of_two()
    }
}

/// Returns the longest step that resolves every motion of the problem's energy, s.
///
/// # Errors
///
/// Refuses the inputs that [`Pendulum::new`] and [`Pendulum::admissible_step`] refuse. The result
/// is infinite if nothing can move, and NaN for a start that is NaN.
pub(super) fn admissible_step(problem: &Problem) -> Result<f64, Error> {
    let pendulum = Pendulum::new(&problem.pendulum)?;
    pendulum.admissible_step(&pendulum.to_state(&problem.start))
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
        let admissible = admissible_step(problem)?;
        let costs = &costs.for_pendulum(&problem.pendulum);
        let is_affordable = |stepping: &Self| costs.of_frame(*stepping) <= frame;
        let most = (frame / costs.fixed64) as u32;
        let in_64_bits = Self::in_64_bits(problem, admissible, most).filter(is_affordable);
        let of_rk4 = || {
            let coarse = Self::rk4(problem, OF_RK4 * admissible, costs)?;
            let fine = Self {
                steps: 2 * coarse.steps,
                ..coarse
            };
            [fine, coarse].into_iter().find(is_affordable)
        };
        Ok(in_64_bits.or_else(of_rk4))
    }

    /// Returns the steps in 64 bits of 0.7 admissible steps, or `most` per frame if that is less, but
    /// at least as many as resolve the motion. `None` if the method refuses it.
    pub(super) fn in_64_bits(problem: &Problem, admissible: f64, most: u32) -> Option<Self> {
        let method = Method::Extrapolation10Fixed64;
        let of = |longest| steps_to_frame(method, problem.rate, longest * admissible);
        let steps = of(RESOLVING).min(most).max(of(COARSEST));
        Self::accepted(method, problem, steps)
    }

    /// Returns RK4 in steps of at most `longest` s, by the method in 32 bits that then costs less.
    /// `None` if both refuse the motion.
    pub(super) fn rk4(problem: &Problem, longest: f64, costs: &Costs) -> Option<Self> {
        let accepted = |method| {
            let steps = steps_to_frame(method, problem.rate, longest);
            Self::accepted(method, problem, steps)
        };
        [Method::Rk4Fixed32, Method::Rk4F32Direction]
            .into_iter()
            .filter_map(accepted)
            .min_by(|a, b| f32::total_cmp(&costs.of_frame(*a), &costs.of_frame(*b)))
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
    /// # Errors
    ///
    /// Refuses what [`initial`](Self::initial) refuses.
    pub fn of(problem: &Problem, method: Method) -> Result<Self, Error> {
        let admissible = admissible_step(problem)?;
        let longest = if method == Method::Extrapolation10Fixed64 {
            RESOLVING
        } else {
            COARSEST
        };

        let steps = steps_to_frame(method, problem.rate, longest * admissible);
        Ok(Self::accepted(method, problem, steps).unwrap_or(Self { method, steps }))
    }

    /// Returns `method` with `steps` steps per frame, or with more if it refuses these as too long.
    ///
    /// Returns `None` if the method refuses the motion for another reason, or if the step count
    /// reaches [`MOST_STEPS`].
    fn accepted(method: Method, problem: &Problem, steps: u32) -> Option<Self> {
        let mut stepping = Self { method, steps };
        while stepping.steps < MOST_STEPS {
            match stepping.check(problem) {
                Ok(()) => return Some(stepping),
                Err(Error::TooLarge {
                    parameter: Parameter::Dt,
                    limit,
                    ..
                }) => {
                    let enough = steps_to_frame(method, problem.rate, limit);

                    // The step count grows with every refusal, so that the loop ends.
                    let more = if method == Method::Extrapolation10Fixed64 {
                        stepping.steps + 1
                    } else {
                        2 * stepping.steps
                    };
                    stepping.steps = enough.max(more);
                }
                Err(_) => return None,
            }
        }
        None
    }

    /// Returns the error of a motion that cannot be started by this method and step count.
    #[inline(never)] // The motion is on the stack.
    pub(super) fn check(self, problem: &Problem) -> Result<(), Error> {
        PlannedRun::new(problem, self).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pendulum::{Motion, Parameters};

    /// Returns the least gravity, m/s^2, for which the method refuses the step as too long. `under`
    /// returns a problem with a given gravity.
    fn refused_gravity(stepping: Stepping, under: impl Fn(f64) -> Problem) -> f64 {
        let [mut accepted, mut refused] = [1e-3, 1e6];
        loop {
            let middle = 0.5 * (accepted + refused);
            if middle <= accepted || middle >= refused {
                return refused;
            }
            match stepping.check(&under(middle)) {
                Ok(()) => accepted = middle,
                Err(_) => refused = middle,
            }
        }
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
            let accepted = Stepping::accepted(method, &edge, steps);
            let expected = Stepping {
                method,
                steps: more,
            };
            assert_eq!(accepted, Some(expected), "{method}, {steps}");
        }

        // The method accepts 65,536 steps, but they are too many.
        let method = Method::Rk4Fixed32;
        let steps = MOST_STEPS;
        assert_eq!(Stepping { method, steps }.check(&under(1.0)), Ok(()));
        assert_eq!(Stepping::accepted(method, &under(1.0), steps), None);
    }
}
