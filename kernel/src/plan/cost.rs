//! What each method costs, what may be spent, and the methods and steps that it pays for.

use super::{PlannedRun, Problem};
use crate::error::{Error, Parameter};
use crate::pendulum::Pendulum;
use crate::table::Method;

/// The price list: what a step costs by each method, what a frame costs in closed form. In cycles, or in any other unit
/// that the [`Budget`] is given in, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// [`Method::ClosedFormF32`], for each frame.
    pub closed_form: f32,
    /// [`Method::Rk4F32DirectionPlain`].
    pub direction_plain: f32,
    /// [`Method::Rk4F32Direction`].
    pub direction: f32,
    /// [`Method::Rk4Fixed32`].
    pub fixed32: f32,
    /// [`Method::Extrapolation10Fixed64`].
    pub fixed64: f32,
    /// To prepare a motion by any of them.
    pub preparation: f32,
}

impl Costs {
    /// What a frame costs that is computed so; infinite for what no plan chooses from.
    #[inline(never)] // one copy
    #[doc(hidden)]
    #[must_use]
    pub fn of_frame(&self, Stepping { method, steps }: Stepping) -> f32 {
        let step = match method {
            Method::ClosedFormF32 => return self.closed_form,
            Method::Rk4F32DirectionPlain => self.direction_plain,
            Method::Rk4F32Direction => self.direction,
            Method::Rk4Fixed32 => self.fixed32,
            Method::Extrapolation10Fixed64 => self.fixed64,
            _ => f32::INFINITY,
        };
        step * steps as f32
    }
}

/// What may be spent, in the unit of the [`Costs`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// On computing a frame.
    pub frame: f32,
    /// On planning.
    pub planning: f32,
}

/// How a motion is computed: a method, and how fine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[doc(hidden)]
pub struct Stepping {
    pub method: Method,
    /// Steps to a frame; of no meaning to the closed form, which has none.
    pub steps: u32,
}

/// In steps of this many admissible ones or less, [`Method::Extrapolation10Fixed64`] is accurate for about as long as in any: its
/// roundings end its horizon, not its steps.
pub(super) const RESOLVING: f64 = 0.7;

/// A scene begins in the first of these steps that a frame can pay for, in admissible ones.
const INITIAL: [f64; 5] = [RESOLVING, 1.0, 1.5, 2.1, FIRST_STEP];

/// The fine run of a reference has steps of this many admissible ones, or of the first of these that planning can pay for. Its error is
/// measured, so that longer steps shorten a horizon and never make it wrong.
const FINE: [f64; 6] = [0.53, 0.65, 0.8, 1.1, 1.5, 2.1];

/// The first step looked at is no longer than this many admissible ones: the fastest rate that the energy allows turns a
/// radian in it. In longer steps two runs could miss alike what neither sees.
pub(super) const FIRST_STEP: f64 = 4.0;

/// RK4 in 32 bits starts with steps no longer than this many admissible ones, the first of them if a
/// frame pays for it. In twice as long steps its error is 16 times as large.
const RESOLVING_RK4: [f64; 2] = [1.0, 2.0];

/// Finer steps than this many to a frame are never tried.
pub(super) const MOST_STEPS: u32 = 1 << 16;

/// The fewest steps by `method` to a frame, of which there are `rate` in a second, that are no longer than `longest` s; in 32
/// bits a power of two, as the steps that refine them.
#[inline(never)] // one copy
pub(super) fn steps_to_frame(method: Method, rate: u16, longest: f64) -> u32 {
    let fewest = libm::ceil(1.0 / (longest * f64::from(rate)));
    let fewest = (fewest as u32).clamp(1, MOST_STEPS);
    if method == Method::Extrapolation10Fixed64 {
        fewest
    } else {
        fewest.next_power_of_two()
    }
}

/// A run in 64 bits and a finer one: the reference of candidates in 32 bits, and candidates themselves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pair {
    pub coarse: Stepping,
    pub fine: Stepping,
}

/// The truncation error of the fine run is taken to be this many times as large as the order says: it may be too low where
/// steps do not resolve the motion.
const TRUST: f32 = 16.0;
/// The least share of the distance to the coarse run that the fine run is taken to be off by.
const LEAST_SHARE: f32 = 1.0 / 32.0;

impl Pair {
    fn new(coarse: u32, fine: u32) -> Self {
        let [coarse, fine] = [coarse, fine].map(|steps| Stepping {
            method: Method::Extrapolation10Fixed64,
            steps,
        });
        Self { coarse, fine }
    }

    /// Returns the pair whose coarse run makes `steps` steps per frame. The fine one makes a third more, or `least` if that is more.
    pub fn of_coarse(steps: u32, least: u32) -> Self {
        let more = (steps / 3).max(1);
        Self::new(steps, steps.saturating_add(more).max(least))
    }

    /// Returns the pairs whose fine run has one of the [`FINE`] steps, the finest first. The coarse run makes at least `least`
    /// steps per frame, and at most `most`.
    ///
    /// If that is fewer than usual, the fine run makes a third more, if these steps resolve the motion.
    pub fn all(
        rate: u16,
        admissible: f64,
        least: u32,
        most: u32,
    ) -> impl DoubleEndedIterator<Item = Self> {
        let steps = move |longest: f64| {
            let method = Method::Extrapolation10Fixed64;
            steps_to_frame(method, rate, longest * admissible).max(2)
        };
        FINE.into_iter().map(move |longest| {
            let fine = steps(longest);
            let coarse = (fine - fine.div_ceil(4)).max(least);
            if coarse > most && most >= least {
                let [.., longest] = FINE;
                Self::of_coarse(most, steps(longest))
            } else {
                Self::new(coarse, fine.max(coarse.saturating_add(1)))
            }
        })
    }

    /// Returns the share of the distance between both runs that the fine one may be off by: by its order, it is
    /// (coarse/fine)^10 if both resolve the motion.
    pub fn share_of_fine(&self) -> f32 {
        let ratio = self.coarse.steps as f32 / self.fine.steps as f32;
        let fifth = ratio * ratio * ratio * ratio * ratio;
        (TRUST * fifth * fifth).clamp(LEAST_SHARE, 1.0)
    }
}

/// The first of [`FINE`] for a pair that is no candidate itself.
pub(super) const JUDGING: usize = 4;

/// The longest step that resolves every motion of the problem's energy, s.
///
/// Refuses what [`Pendulum::new`] and [`Pendulum::admissible_step`] refuse.
#[inline(never)] // one copy
pub(super) fn admissible_step(problem: &Problem) -> Result<f64, Error> {
    let pendulum = Pendulum::new(&problem.pendulum)?;
    pendulum.admissible_step(&pendulum.to_state(&problem.start))
}

impl Stepping {
    /// Returns the method and step count to start with, before planning has produced a result.
    ///
    /// They resolve every motion of the problem's energy, and a frame costs no more than `frame`.
    /// In the order of preference:
    ///
    /// 1. [`Method::Extrapolation10Fixed64`] in steps whose roundings are the larger error;
    /// 2. the same in the longest steps that a search tries;
    /// 3. RK4 in 32 bits, by the method whose steps cost less, in [admissible
    ///    steps](Pendulum::admissible_step);
    /// 4. the same in twice as long steps. Longer ones gain or lose several percent of the energy
    ///    within seconds.
    ///
    /// Returns `None` if a frame pays for none of these.
    ///
    /// # Errors
    ///
    /// Refuses what [`Pendulum::new`] and [`Pendulum::admissible_step`] refuse.
    #[doc(hidden)]
    pub fn initial(problem: &Problem, costs: &Costs, frame: f32) -> Result<Option<Self>, Error> {
        let admissible = admissible_step(problem)?;
        let in_32_bits = if costs.fixed32 < costs.direction {
            [Method::Rk4Fixed32, Method::Rk4F32Direction]
        } else {
            [Method::Rk4F32Direction, Method::Rk4Fixed32]
        };
        let of = |(method, longest): (Method, f64)| {
            Self::affordable(method, problem, longest * admissible, costs, frame)
        };

        let in_64_bits = INITIAL
            .map(|longest| (Method::Extrapolation10Fixed64, longest))
            .into_iter()
            .find_map(of);
        Ok(in_64_bits.or_else(|| {
            RESOLVING_RK4
                .into_iter()
                .flat_map(|longest| in_32_bits.map(|method| (method, longest)))
                .find_map(of)
        }))
    }

    /// Returns `method` in the longest steps that a search tries first or, if the method refuses
    /// these as too long, in the longest that it accepts.
    ///
    /// # Errors
    ///
    /// Refuses what [`initial`](Self::initial) refuses.
    #[doc(hidden)]
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

    /// Returns [`Method::Extrapolation10Fixed64`] in steps of `longest` s or less, as
    /// [`affordable`](Self::affordable).
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

    /// Returns `method` in `steps` steps to a frame, or in more if it refuses these as too long.
    /// Returns `None` if it refuses the motion, or if the step count is not `allowed`.
    #[inline(never)] // Not inlined, to save flash.
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

    /// Refuses a motion that cannot be started so.
    #[inline(never)] // the motion stands on the stack
    fn check(self, problem: &Problem) -> Result<(), Error> {
        PlannedRun::new(problem, self).map(|_| ())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pendulum that needs some steps per frame, on a chip that can pay for none, few and many.
    #[test]
    fn pairs_are_two_runs_and_keep_their_limits() {
        for admissible in [1e-4, 1e-3, 3e-3, 1e-2, 1.0] {
            for [least, most] in [[1, u32::MAX], [1, 3], [2, 9], [5, 3]] {
                let pairs = || Pair::all(60, admissible, least, most);
                let mut finer = u32::MAX;
                for Pair { coarse, fine } in pairs() {
                    assert!(least <= coarse.steps && coarse.steps < fine.steps);
                    assert!(coarse.steps <= most || most < least);
                    assert!(fine.steps <= finer);
                    finer = fine.steps;
                }
                // However few steps a frame can pay for, the fine run resolves the motion.
                let [.., longest] = FINE;
                let resolving = 1.0 / (60.0 * longest * admissible);
                assert!(pairs().all(|pair| f64::from(pair.fine.steps) >= resolving.floor()));
            }
        }
    }

    /// Twice the steps reduce an error of order 10 by 2^10; what is allowed for is more.
    #[test]
    fn the_fine_run_is_off_by_a_share_of_the_distance() {
        assert_eq!(Pair::new(3, 6).share_of_fine(), LEAST_SHARE);
        assert_eq!(Pair::new(99, 100).share_of_fine(), 1.0);
        let share = Pair::new(3, 4).share_of_fine();
        assert!((share / (TRUST * 0.75_f32.powi(10)) - 1.0).abs() < 1e-5);
    }
}
