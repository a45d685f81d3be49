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
/// [`CORTEX_M0PLUS`](Self::CORTEX_M0PLUS).
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// The longest step of [`Method::Extrapolation10Fixed64`] that resolves a motion, in admissible
/// steps.
///
/// Shorter steps give almost the same horizon, because rounding errors end it.
pub(super) const RESOLVING: f64 = 0.7;

/// The steps in 64 bits that a motion may start with before it is planned, in admissible steps. The
/// first of them is used that a frame can pay for.
const INITIAL: [f64; 5] = [RESOLVING, 1.0, 1.5, 2.1, FIRST_STEP];

/// The steps of the fine run of a reference, in admissible steps. The first of them is used that
/// planning can pay for.
///
/// The last two are too long for candidates in 64 bits, because there errors do not fall evenly
/// with the steps: runs with 3 and 4 steps per frame have had errors that differed by 5 %, and were
/// 500 times as large as with 5 steps. They are good enough to judge candidates in 32 bits, whose
/// errors are larger.
const FINE: [f64; 6] = [0.53, 0.65, 0.8, LONGEST_IN_64_BITS, 1.5, 2.1];
/// The longest of these that judge candidates in 64 bits.
const LONGEST_IN_64_BITS: f64 = 1.1;

/// The longest step of a candidate in 64 bits, in admissible steps, if a rod starts near upright
/// and 32 bits are fixed point, which is not trusted there.
///
/// Steps longer than [`FIRST_STEP`] do not resolve every motion of the energy, but the fine run
/// that they are compared with does. They are for frames that cannot pay for shorter ones, as with
/// a heavy bob 2 on a slow processor. Elsewhere 32 bits are accurate for longer, also `f32` near
/// upright.
pub(super) const LONGEST_NEAR_UPRIGHT: f64 = 16.0;

/// The preferred longest step of the first trial, in admissible steps.
///
/// In this step the fastest rate that the energy allows advances a phase by a radian. In longer
/// steps, two runs could miss the same fast motion and agree.
pub(super) const FIRST_STEP: f64 = 4.0;

/// The longest of the usual first steps ([`FIRST_STEPS`]), in admissible steps. A search begins in
/// longer ones only if a frame cannot pay for these. In longer steps the error bounds have a larger
/// factor (`MISSED_ALIKE` of the trial).
pub(super) const LONGEST_USUAL: f64 = 64.0;

/// The usual longest steps of the first trial in 32 bits, in admissible steps.
///
/// The first one is used that both budgets can pay for: a frame, and planning in a trial of all
/// frames with three finer runs. If planning cannot pay for the last one but a frame can, the last
/// one is used.
///
/// Steps longer than [`FIRST_STEP`] are useful because, with very unlike masses, a motion is far
/// slower than the fastest rate that its energy allows. Fixed point refuses steps of 16 admissible
/// steps or more. The search then doubles the step count, or changes to `f32` if a frame can only
/// pay for that.
pub(super) const FIRST_STEPS: [f64; 5] = [FIRST_STEP, 8.0, 16.0, 32.0, LONGEST_USUAL];

/// The longest steps of the first trial in 32 bits if a frame cannot pay for the last of the
/// [`FIRST_STEPS`], in admissible steps. The first one is used that both budgets can pay for, or
/// else the last one.
///
/// With a heavy bob 2 on a short rod, steps of 2000 admissible steps were accurate enough
/// (measured). Test `plan_study` checks the predictions of such trials against the exact motion.
/// They are for `f32`, because fixed point refuses them.
pub(super) const LONG_FIRST_STEPS: [f64; 5] = [128.0, 256.0, 512.0, 1024.0, 2048.0];

/// The longest steps of RK4 in 32 bits that a motion may start with, in admissible steps. The first
/// of them is used if a frame can pay for it. In twice as long steps the error is 16 times as
/// large.
const RESOLVING_RK4: [f64; 2] = [1.0, 2.0];

/// The largest number of steps per frame that a search begins a trial with. Other candidates of
/// that trial may take up to 4 times as many. A [`Search::of`](super::Search::of) takes any number.
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

/// The reference of a trial: a coarse and a fine run in 64 bits. Both may also be candidates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair {
    /// The run in longer steps, usually by a third.
    pub coarse: Stepping,
    /// The run that others are compared with. Both are by [`Method::Extrapolation10Fixed64`].
    pub fine: Stepping,
}

/// A safety factor on the truncation error of the fine run. The order of the method gives too small
/// a value if the steps do not resolve the motion.
const TRUST: f32 = 16.0;
/// The smallest share of the distance to the coarse run that is assumed as the error of the fine
/// run.
const LEAST_SHARE: f32 = 1.0 / 32.0;

impl Pair {
    /// Creates a pair from the steps per frame of its runs. `coarse` must be less than `fine`.
    pub fn new(coarse: u32, fine: u32) -> Self {
        let [coarse, fine] = [coarse, fine].map(|steps| Stepping {
            method: Method::Extrapolation10Fixed64,
            steps,
        });
        Self { coarse, fine }
    }

    /// Returns the pair whose coarse run makes `steps` steps per frame.
    ///
    /// The fine run makes a third more steps, rounded down, but at least one more, and in all at
    /// least `least`. Its step count is limited to 2^32 - 1, so that both are equal if `steps` is
    /// that number. `steps` must not be 0; this is not checked.
    pub fn of_coarse(steps: u32, least: u32) -> Self {
        let more = (steps / 3).max(1);
        Self::new(steps, steps.saturating_add(more).max(least))
    }

    /// Returns six pairs, one for each of the [`FINE`] steps of the fine run, from 0.53 to 2.1
    /// admissible steps. The finest comes first.
    ///
    /// `rate` is the number of frames per second, and `admissible` the admissible step, s. The fine
    /// run makes from 2 to 65,536 ([`MOST_STEPS`]) steps per frame: 65,536 if `rate` or
    /// `admissible` is 0, and 2 if `admissible` is infinite or NaN. The coarse run makes three
    /// quarters of them, rounded down, but at least `least`. The fine run always makes more than
    /// the coarse run, even if that is more than 65,536.
    ///
    /// The coarse run makes at most `most` steps, unless `most` is less than `least`. If this limit
    /// applies, the fine run makes the larger one of two numbers of steps: the largest whose three
    /// quarters, rounded down, are `most`; and its usual number or that for 1.1 admissible steps,
    /// whichever is less. Successive pairs may be equal.
    pub fn all(
        rate: u16,
        admissible: f64,
        least: u32,
        most: u32,
    ) -> impl DoubleEndedIterator<Item = Self> + Clone {
        let steps = move |longest: f64| {
            let method = Method::Extrapolation10Fixed64;
            steps_to_frame(method, rate, longest * admissible).max(2)
        };
        FINE.into_iter().map(move |longest| {
            let fine = steps(longest);
            let coarse = (fine - fine.div_ceil(4)).max(least);
            if coarse > most && most >= least {
                let widest = most.saturating_add(most / 3).saturating_add(1);
                Self::new(most, widest.max(fine.min(steps(LONGEST_IN_64_BITS))))
            } else {
                Self::new(coarse, fine.max(coarse.saturating_add(1)))
            }
        })
    }

    /// Returns true if the distance between both runs measures their own errors, so that they may
    /// be candidates: if the steps of the fine run are at most 1.1 admissible steps long, or if it
    /// makes 65,536 steps per frame.
    pub fn judges_64_bits(&self, rate: u16, admissible: f64) -> bool {
        let longest = LONGEST_IN_64_BITS * admissible;
        self.fine.steps >= steps_to_frame(self.fine.method, rate, longest)
    }

    /// Returns the share of the distance between both runs that bounds the truncation error of the
    /// fine run. If its steps do not resolve the motion, it is 1. Otherwise it is 16 ([`TRUST`])
    /// times (coarse/fine)^10, but at least 1/32 ([`LEAST_SHARE`]) and at most 1. Here coarse and
    /// fine are the step counts. They must not be 0; this is not checked.
    ///
    /// If both runs resolve the motion, the order of the method gives (coarse/fine)^10.
    /// `admissible` is the [longest step](admissible_step) that resolves the motion, s, and `rate`
    /// the number of frames per second.
    pub fn share_of_fine(&self, rate: u16, admissible: f64) -> f32 {
        let step = 1.0 / (f64::from(rate) * f64::from(self.fine.steps));
        if step > admissible {
            return 1.0;
        }
        let ratio = self.coarse.steps as f32 / self.fine.steps as f32;
        let fifth = ratio * ratio * ratio * ratio * ratio;
        (TRUST * fifth * fifth).clamp(LEAST_SHARE, 1.0)
    }
}

/// The index in [`Pair::all`] of the finest pair that is used if its runs are no candidates.
pub(super) const JUDGING: usize = 4;

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
    /// Returns the method and step count to start with, before planning has produced a result.
    ///
    /// They are the first of the following whose frame costs at most `frame`:
    ///
    /// 1. [`Method::Extrapolation10Fixed64`] in steps of 0.7 [admissible
    ///    steps](Pendulum::admissible_step). Shorter steps are hardly more accurate, because then
    ///    rounding is the larger error;
    /// 2. the same in steps of 1, 1.5, 2.1 or 4 admissible steps;
    /// 3. RK4 in admissible steps, by [`Method::Rk4Fixed32`] or [`Method::Rk4F32Direction`]: first
    ///    by the one whose steps cost less, then by the other one;
    /// 4. the same in twice as long steps. Longer ones gain or lose several percent of the energy
    ///    within seconds.
    ///
    /// These lengths are upper limits. The step count is rounded up, for RK4 to a power of two, and
    /// increased if the method refuses the steps as too long. It is 1 if nothing can move.
    ///
    /// `frame` is the frame budget in the unit of `costs`. Neither is checked; a NaN pays for
    /// nothing. The tolerance and the duration are not used. Returns `None` if a frame pays for
    /// none of these, if they take 65,536 steps per frame or more, or if the methods refuse the
    /// motion, such as a start that is not finite or a rate of 0.
    ///
    /// # Errors
    ///
    /// Refuses a pendulum that [`Pendulum::new`] or [`Pendulum::admissible_step`] refuses: with
    /// masses or lengths that are not finite or not positive, with a gravity that is not finite or
    /// negative, or with numbers out of range.
    pub fn initial(problem: &Problem, costs: &Costs, frame: f32) -> Result<Option<Self>, Error> {
        let admissible = admissible_step(problem)?;
        let costs = &costs.for_pendulum(&problem.pendulum);

        // In 32 bits the method whose step costs less comes first.
        let in_32_bits = if costs.fixed32 < costs.direction {
            [Method::Rk4Fixed32, Method::Rk4F32Direction]
        } else {
            [Method::Rk4F32Direction, Method::Rk4Fixed32]
        };

        // Try a method in steps of at most `longest` admissible steps.
        let of = |(method, longest): (Method, f64)| {
            Self::affordable(method, problem, longest * admissible, costs, frame)
        };

        // Items 1 and 2 of the order of preference.
        let in_64_bits = INITIAL
            .map(|longest| (Method::Extrapolation10Fixed64, longest))
            .into_iter()
            .find_map(of);

        // Items 3 and 4, if 64 bits are refused or too expensive.
        Ok(in_64_bits.or_else(|| {
            RESOLVING_RK4
                .into_iter()
                .flat_map(|longest| in_32_bits.map(|method| (method, longest)))
                .find_map(of)
        }))
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
            FIRST_STEP
        };

        let steps = steps_to_frame(method, problem.rate, longest * admissible);
        Ok(Self::accepted(method, problem, steps, |_| true).unwrap_or(Self { method, steps }))
    }

    /// Returns true if the steps resolve every motion of the problem's energy. Those of
    /// [`Method::ClosedFormF32`] always do. Those of [`Method::Extrapolation10Fixed64`] may be up
    /// to four admissible steps long. Every other method is judged as RK4. Its step count must be
    /// at least the smallest power of two whose steps are at most two [admissible
    /// steps](Pendulum::admissible_step) long, or 65,536 if that is less; 0 is too few, although a
    /// motion counts 0 as 1. In longer steps RK4 gains or loses several percent of the energy
    /// within seconds, or diverges. The start and the rate are not checked.
    ///
    /// # Errors
    ///
    /// Refuses what [`initial`](Self::initial) refuses.
    #[doc(hidden)] // For the firmware's planner.
    pub fn resolves(self, problem: &Problem) -> Result<bool, Error> {
        let [.., of_rk4] = RESOLVING_RK4;
        let longest = match self.method {
            Method::Extrapolation10Fixed64 => FIRST_STEP,
            _ => of_rk4,
        };
        let longest = longest * admissible_step(problem)?;
        let enough = steps_to_frame(self.method, problem.rate, longest);
        Ok(self.method == Method::ClosedFormF32 || self.steps >= enough)
    }

    /// Returns [`Method::Extrapolation10Fixed64`] in steps of `longest` s or less, with the fewest
    /// steps per frame that it accepts.
    ///
    /// Returns `None` if a frame then costs more than `frame`, in the unit of `costs`, if it takes
    /// 65,536 steps or more, or if the method refuses the motion.
    pub(super) fn fixed64(
        problem: &Problem,
        longest: f64,
        costs: &Costs,
        frame: f32,
    ) -> Option<Self> {
        let method = Method::Extrapolation10Fixed64;
        Self::affordable(method, problem, longest, costs, frame)
    }

    /// Returns `method` in steps of `longest` s or less, as coarse as its numbers take. Returns
    /// `None` if a frame then costs more than `frame`, or if the method refuses the motion.
    fn affordable(
        method: Method,
        problem: &Problem,
        longest: f64,
        costs: &Costs,
        frame: f32,
    ) -> Option<Self> {
        let steps = steps_to_frame(method, problem.rate, longest);
        Self::accepted(method, problem, steps, |stepping| {
            costs.of_frame(stepping) <= frame
        })
    }

    /// Returns `method` with `steps` steps per frame, or with more if it refuses these as too long.
    ///
    /// Returns `None` if the method refuses the motion for another reason, if the step count is not
    /// `allowed`, or if it reaches [`MOST_STEPS`].
    fn accepted(
        method: Method,
        problem: &Problem,
        steps: u32,
        allowed: impl Fn(Self) -> bool,
    ) -> Option<Self> {
        let mut stepping = Self { method, steps };
        while allowed(stepping) && stepping.steps < MOST_STEPS {
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
    fn check(self, problem: &Problem) -> Result<(), Error> {
        PlannedRun::new(problem, self).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pendulum::{Motion, Parameters};

    /// Pendulums that need different step counts, on chips that can pay for few or for many steps.
    ///
    /// Each pair has its coarse run between `least` and `most` steps and its fine run above that.
    /// If `most` is below `least`, only `least` counts. No pair is finer than the one before, and
    /// every fine run makes at least as many steps as the longest of the [`FINE`] steps needs. At
    /// 0.0032162 s, a limit of 5 steps applies to fine runs of 10 and 8 steps, but not to one of 7.
    #[test]
    fn pairs_keep_their_step_limits_and_resolve_the_motion() {
        for admissible in [1e-4, 1e-3, 3e-3, 0.0032162, 1e-2, 1.0] {
            for [least, most] in [[1, u32::MAX], [1, 3], [1, 5], [1, 9], [2, 9], [5, 3]] {
                let pairs = || Pair::all(60, admissible, least, most);
                let mut finer = u32::MAX;
                for Pair { coarse, fine } in pairs() {
                    assert!(least <= coarse.steps && coarse.steps < fine.steps);
                    assert!(coarse.steps <= most || most < least);
                    assert!(fine.steps <= finer);
                    finer = fine.steps;
                }

                // If the usual coarse run is within the limit, the pair is unchanged.
                for (pair, usual) in pairs().zip(Pair::all(60, admissible, least, u32::MAX)) {
                    assert!(pair == usual || usual.coarse.steps > most);
                }

                // The fine run resolves the motion, even if a frame can pay for a few steps only.
                let [.., longest] = FINE;
                let resolving = 1.0 / (60.0 * longest * admissible);
                assert!(pairs().all(|pair| f64::from(pair.fine.steps) >= resolving.floor()));
            }
        }

        // Three quarters of 7 steps, rounded down, are 5 steps, but those of 8 steps are 6.
        let finest = Pair::all(60, 0.0032162, 1, 5).next();
        assert_eq!(finest, Some(Pair::new(5, 7)));
    }

    /// The runs of a pair may be candidates if the steps of the fine run are at most 1.1 admissible
    /// steps long. At 60 frames per second and an admissible step of 0.0032162 s, each of 5 steps
    /// per frame is 1.04 admissible steps long, and each of 4 is 1.30.
    #[test]
    fn pairs_judge_64_bits_in_steps_that_resolve_the_motion() {
        let judges = |coarse, fine| Pair::new(coarse, fine).judges_64_bits(60, 0.0032162);
        assert!(judges(3, 5));
        assert!(!judges(3, 4));
    }

    /// The share of the distance that is assumed as the error of the fine run is 1/32
    /// ([`LEAST_SHARE`]) with twice the steps of the coarse run, 1 with one percent more, and 16
    /// ([`TRUST`]) times 0.75^10 with a third more. Twice the steps reduce an error of order 10 by
    /// 2^10; the assumed share is larger. If the steps do not resolve the motion, it is 1.
    #[test]
    fn share_of_the_fine_run_follows_from_its_order_within_limits() {
        let share = |coarse, fine| Pair::new(coarse, fine).share_of_fine(60, 0.01);
        assert_eq!(share(3, 6), LEAST_SHARE);
        assert_eq!(share(99, 100), 1.0);
        assert_eq!(Pair::new(3, 6).share_of_fine(60, 0.0027), 1.0);
        let share = share(3, 4);
        assert!((share / (TRUST * 0.75_f32.powi(10)) - 1.0).abs() < 1e-5);
    }

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

    /// RK4 resolves a motion if its step count is at least the smallest power of two whose steps
    /// are at most two admissible steps long, and extrapolation if its steps are at most four of
    /// them. The closed form always resolves it.
    #[test]
    fn steps_of_a_few_admissible_steps_resolve_a_motion() -> Result<(), Error> {
        let problem = Problem {
            pendulum: Parameters::equal_rods(1.0, 0.01, 9.81),
            start: Motion::at_rest(1.0, 1.0),
            tolerance: 0.01,
            duration: 1.0,
            rate: 60,
        };
        let admissible = admissible_step(&problem)?;
        let in_64_bits = (1.0 / (60.0 * 4.0 * admissible)).ceil() as u32;
        let by_rk4 = (1.0 / (60.0 * 2.0 * admissible)).log2().ceil().exp2() as u32;
        for &method in Method::DRAWN {
            let is_closed = method == Method::ClosedFormF32;
            let enough = match method {
                Method::Extrapolation10Fixed64 => in_64_bits,
                _ => by_rk4,
            };
            // The three step counts below must be different.
            assert!(enough >= 3);
            for (steps, expected) in [(1, is_closed), (enough - 1, is_closed), (enough, true)] {
                let stepping = Stepping { method, steps };
                assert_eq!(stepping.resolves(&problem)?, expected, "{stepping:?}");
            }
        }
        Ok(())
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
            let accepted = Stepping::accepted(method, &edge, steps, |_| true);
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
        assert_eq!(
            Stepping::accepted(method, &under(1.0), steps, |_| true),
            None
        );
    }
}
