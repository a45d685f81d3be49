//! The steps and runs that the budgets of a search can pay for: the first steps, the steps in 64
//! bits, and the runs that a trial is compared with.

use core::ops::Range;

use super::{Goal, Purpose, Search};
use crate::bounds::stable_step;
use crate::plan::cost::{FIRST_STEPS, JUDGING, LONG_FIRST_STEPS, Pair, RESOLVING, steps_to_frame};
use crate::plan::shadow::Shadows;
use crate::plan::trial::{Judges, MOST_FINER_RUNS, Trial};
use crate::plan::{Budget, Costs, Problem, Stepping};
use crate::table::Method;

/// A reference, or a number of finer runs, is affordable if planning can pay for it for this many
/// times the longest known horizon. The second number is used if nothing is affordable with the
/// first.
///
/// The first is 2.75 because 64 bits are accurate for more than twice as long as the first trial in
/// 32 bits. The second is 1.25 because finer steps in 32 bits may be accurate for that long.
pub(super) const MARGINS: [f32; 2] = [2.75, 1.25];

/// The margin that comes before the [`MARGINS`] in a trial in 64 bits, unless the best known
/// candidate is in 64 bits.
///
/// In chaotic motions 64 bits are often accurate for four times as long as coarse steps in 32 bits,
/// and longer. The value is measured: 4.5 and 8 give horizons of about the same length.
const FIRST_MARGIN_IN_64_BITS: f32 = 6.0;

/// The cost of a trial with a reference, divided by the cost of a trial with three finer runs.
/// Above this ratio, the reference is too expensive if planning cannot pay for half of all frames.
const EXPENSIVE: f32 = 5.0;

/// Returns the steps per frame of the first trial in 32 bits, by `method`.
///
/// The step is the shortest of the [`FIRST_STEPS`] that both budgets can pay for: a frame, and
/// planning to the end of the problem. If planning cannot pay for the longest one but a frame can,
/// it is that one. If a frame cannot, it is the shortest of the [`LONG_FIRST_STEPS`] that both can
/// pay for, or the longest.
///
/// The faster normal mode advances by at most a radian in a step. `admissible` is the admissible
/// step, s.
pub(super) fn first_steps(
    method: Method,
    problem: &Problem,
    admissible: f64,
    costs: &Costs,
    budget: &Budget,
) -> u32 {
    let longest = stable_step(&problem.pendulum, 1.0);
    let to_frame = |step: f64| {
        let step = f64::min(step * admissible, longest);
        steps_to_frame(method, problem.rate, step)
    };
    let frame_can_pay = |steps| costs.of_frame(Stepping { method, steps }) <= budget.frame;
    let both_can_pay = |&steps: &u32| {
        let judges = Judges::FinerRuns(MOST_FINER_RUNS);
        let cost = Trial::cost(costs, Stepping { method, steps }, judges);
        frame_can_pay(steps) && cost * problem.frames() as f32 <= budget.planning
    };

    // Longer steps than usual are only for frames that cannot pay for the usual ones. If only
    // planning cannot, they seldom give a longer horizon (measured).
    let usual = FIRST_STEPS.map(to_frame);
    let [.., fewest] = usual;
    if let Some(steps) = usual.into_iter().find(both_can_pay) {
        return steps;
    }
    if frame_can_pay(fewest) {
        return fewest;
    }
    let long = LONG_FIRST_STEPS.map(to_frame);
    let [.., fewest] = long;
    long.into_iter().find(both_can_pay).unwrap_or(fewest)
}

impl Search {
    /// Returns the reference for the trial of `self.stepping`: the finest that planning can pay
    /// for and that is not too expensive, or `None`.
    ///
    /// A trial in 64 bits has one in any case. In the evaluation of a method in 64 bits, the trial
    /// is the coarse run of the pair.
    pub(super) fn affordable_reference(&self) -> Option<Pair> {
        let is_in_64_bits = self.stepping_is_in_64_bits();

        // In the evaluation of a method in 64 bits, its own run is the coarse run.
        if matches!(self.goal, Goal::Evaluate { .. }) && is_in_64_bits {
            let Stepping { method, steps } = self.stepping;
            let resolving = steps_to_frame(method, self.problem.rate, self.admissible);
            return Some(Pair::of_coarse(steps, resolving));
        }

        // A trial in 64 bits uses the coarsest pair that can judge it if planning can pay for none.
        let coarsest = || self.pairs()?.nth(JUDGING - 1);
        self.pair_within_budget(self.stepping)
            .or_else(|| coarsest().filter(|_| is_in_64_bits))
    }

    /// Returns the reference of a trial of `stepping`: the finest one that planning can pay for.
    /// Returns `None` if it can pay for none, if all of those are too expensive, or if 64 bits
    /// refuse the motion.
    pub(super) fn pair_within_budget(&self, stepping: Stepping) -> Option<Pair> {
        // Without candidates in 64 bits, or if planning cannot pay for a pair that judges them, a
        // coarse pair is good enough.
        let coarse = || self.first_affordable(stepping, JUDGING..usize::MAX, 0.0);
        let is_in_64_bits = stepping.method == Method::Extrapolation10Fixed64;
        self.judging_pair(stepping)
            .or_else(|| coarse().filter(|_| !is_in_64_bits))
    }

    /// Returns the finest affordable reference of a trial of `stepping` in which the runs of the
    /// reference are candidates themselves.
    ///
    /// Returns `None` if planning or a frame cannot pay for it, if it is too expensive, if 64 bits
    /// refuse the motion, or if the trial has no candidates in 64 bits: as the first trial or to
    /// evaluate one method.
    pub(super) fn judging_pair(&self, stepping: Stepping) -> Option<Pair> {
        // The first trial has no candidates in 64 bits, because it ends early in a chaotic motion
        // and takes long in a regular one.
        let is_in_64_bits = stepping.method == Method::Extrapolation10Fixed64;
        let has_candidates = match self.goal {
            Goal::FindBest { .. } => is_in_64_bits || self.is_refined(),
            Goal::Evaluate { .. } => false,
        };
        // A frame must be able to pay for 64 bits.
        if !has_candidates || self.most_in_64_bits() < self.least_in_64_bits? {
            return None;
        }
        self.first_affordable(stepping, 0..JUDGING, self.cost_of_shadows())
    }

    /// Returns all possible references, the finest first, or `None` if 64 bits refuse the motion. A
    /// frame can pay for the coarse run of each, if it can pay for 64 bits at all.
    pub(super) fn pairs(&self) -> Option<impl DoubleEndedIterator<Item = Pair> + Clone> {
        let [least, most] = [self.least_in_64_bits?, self.most_in_64_bits()];
        Some(Pair::all(self.problem.rate, self.admissible, least, most))
    }

    /// Returns the first pair with an index in `indices` ([`Pair::all`]) that planning can pay for
    /// in a trial of `stepping`, at the largest possible margin ([`FIRST_MARGIN_IN_64_BITS`],
    /// [`MARGINS`]). `shadows` is the cost of a frame of the shadows. Pairs that are [too
    /// expensive](Self::is_too_expensive) are left out if `stepping` is in 32 bits, unless it is
    /// [well measured](Self::is_well_measured) already.
    fn first_affordable(
        &self,
        stepping: Stepping,
        indices: Range<usize>,
        shadows: f32,
    ) -> Option<Pair> {
        let pairs = self.pairs()?.take(indices.end).skip(indices.start);

        // Steps in 32 bits are first measured with finer runs if a reference is too expensive.
        let is_in_64_bits = stepping.method == Method::Extrapolation10Fixed64;
        let may_be_expensive = is_in_64_bits || self.is_well_measured(stepping.steps);

        // The first margin is for 64 bits only. If the best candidate is in 64 bits, their horizon
        // is known, and the last margin is enough.
        let best = self.known();
        let is_known =
            best.is_some_and(|best| best.stepping.method == Method::Extrapolation10Fixed64);
        let margins = [FIRST_MARGIN_IN_64_BITS].into_iter().chain(MARGINS);
        let skipped = match (is_in_64_bits, is_known) {
            (true, false) => 0,
            (false, false) => 1,
            (_, true) => 2,
        };
        margins.skip(skipped).find_map(|margin| {
            pairs.clone().find(|&pair| {
                let judges = Judges::Reference(pair);
                let cost = Trial::cost(&self.costs, stepping, judges) + shadows;
                cost * self.frames_to_pay(margin) <= self.budget.planning - self.spent
                    && (may_be_expensive || !self.is_too_expensive(stepping, cost))
            })
        })
    }

    /// Returns true if the best known candidate is in 32 bits, by any method, has these steps per
    /// frame, and was measured with a reference or with three finer runs.
    fn is_well_measured(&self, steps: u32) -> bool {
        self.known().is_some_and(|best| {
            best.stepping.method != Method::Extrapolation10Fixed64
                && best.stepping.steps == steps
                && !(1..MOST_FINER_RUNS).contains(&best.finer_runs)
        })
    }

    /// Returns true if a reference is too expensive: if planning cannot pay for half of all frames
    /// of a trial that costs `cost` per frame, and a trial of `stepping` with three finer runs
    /// costs less than a fifth of that.
    pub(super) fn is_too_expensive(&self, stepping: Stepping, cost: f32) -> bool {
        let finer_runs = Judges::FinerRuns(MOST_FINER_RUNS);
        let left = self.budget.planning - self.spent;
        0.5 * cost * self.problem.frames() as f32 > left
            && cost > EXPENSIVE * Trial::cost(&self.costs, stepping, finer_runs)
    }

    /// Returns true if the trial of `self.stepping` has to measure how fast errors grow, before
    /// `reference` measures the horizons.
    ///
    /// It has to if no frame is known to be accurate yet. If errors grow fast, the motion is
    /// probably chaotic, and planning pays for 64 bits instead of `reference`. That helps only if a
    /// frame can pay for them, if planning cannot pay for the finest reference to the end of the
    /// problem, and if a trial with that reference costs more than 5 times as much as one with
    /// three finer runs ([`EXPENSIVE`]), which a trial in 64 bits never does. If errors grow
    /// slowly, planning must still be able to pay for `reference` to the end.
    pub(super) fn must_measure_growth(&self, reference: Pair) -> bool {
        let is_first =
            self.purpose == Purpose::Horizon && matches!(self.goal, Goal::FindBest { best: None });
        if !is_first || self.in_64_bits().is_none() {
            return false;
        }
        let Some(finest) = self.pairs().and_then(|mut pairs| pairs.next()) else {
            return false;
        };

        let cost = |judges| Trial::cost(&self.costs, self.stepping, judges);
        let of_growth = cost(Judges::FinerRuns(MOST_FINER_RUNS));
        let of_finest = cost(Judges::Reference(finest));

        // The trial that measures the growth ends in the middle of the problem at the latest.
        let of_both = cost(Judges::Reference(reference)) + 0.5 * of_growth;
        let all = self.problem.frames() as f32;
        let left = self.budget.planning - self.spent;
        of_finest > EXPENSIVE * of_growth && of_finest * all > left && of_both * all <= left
    }

    /// Returns the number of finer runs for the trial of `self.stepping`: the largest that planning
    /// can pay for, at the largest possible margin ([`MARGINS`]). If planning can pay for none, it
    /// is the smallest allowed number. The evaluation of one method has three.
    pub(super) fn affordable_finer_runs(&self) -> u8 {
        if let Goal::Evaluate { .. } = self.goal {
            return MOST_FINER_RUNS;
        }

        // After a better measurement, a single finer run shows no longer horizon: in twice the
        // steps the truncation error is 1/16, but the factor of the bound is 37 times as large.
        let is_rough = self.known().is_none_or(|best| best.finer_runs == 1);
        let least = self.least_finer_runs.max(if is_rough { 1 } else { 2 });
        let numbers = || (least..=MOST_FINER_RUNS).rev();
        let affordable = MARGINS.into_iter().find_map(|margin| {
            let frames = self.frames_to_pay(margin);
            numbers().find(|&number| self.can_pay(self.stepping, number, frames))
        });
        affordable.unwrap_or(least)
    }

    /// Returns true if planning can pay for a trial of `in_64_bits` with the coarsest reference
    /// that judges 64 bits, at the first of the [`MARGINS`].
    pub(super) fn can_pay_for_64_bits(&self, in_64_bits: Stepping) -> bool {
        let [margin, _] = MARGINS;
        let Some(coarsest) = self.pairs().and_then(|mut pairs| pairs.nth(JUDGING - 1)) else {
            return false;
        };
        let cost = Trial::cost(&self.costs, in_64_bits, Judges::Reference(coarsest));
        (cost + self.cost_of_shadows()) * self.frames_to_pay(margin)
            <= self.budget.planning - self.spent
    }

    /// Returns the cost of a frame of the shadows.
    fn cost_of_shadows(&self) -> f32 {
        let rate = self.problem.rate;
        Shadows::cost_of_frame(self.shadow(), self.admissible, rate, &self.costs)
    }

    /// Returns true if planning can pay for a trial of `stepping` with this number of finer runs,
    /// for this number of frames.
    pub(super) fn can_pay(&self, stepping: Stepping, finer_runs: u8, frames: f32) -> bool {
        let cost = Trial::cost(&self.costs, stepping, Judges::FinerRuns(finer_runs));
        cost * frames <= self.budget.planning - self.spent
    }

    /// Returns the number of frames that the next trial may need: `margin` times the longest known
    /// horizon, but at most all frames, or all of them if no frame is known to be accurate.
    pub(super) fn frames_to_pay(&self, margin: f32) -> f32 {
        let all = self.problem.frames() as f32;
        let longer = margin * self.known().map_or(0, |best| best.accurate_frames) as f32;
        if 0.0 < longer && longer < all {
            longer
        } else {
            all
        }
    }

    /// Returns the candidate in 64 bits: in steps that resolve the motion or, if a frame cannot pay
    /// for these, as many as it can pay for. Returns `None` if these are fewer than the method
    /// accepts.
    pub(super) fn in_64_bits(&self) -> Option<Stepping> {
        let least = self.least_in_64_bits?;
        let method = Method::Extrapolation10Fixed64;
        let resolving = steps_to_frame(method, self.problem.rate, RESOLVING * self.admissible);
        let most = self.most_in_64_bits();
        let steps = resolving.min(most);
        (steps >= least).then_some(Stepping { method, steps })
    }

    /// Returns the number of steps in 64 bits that a frame can pay for.
    pub(super) fn most_in_64_bits(&self) -> u32 {
        self.most_steps(Method::Extrapolation10Fixed64)
    }

    /// Returns the number of steps by `method` that a frame can pay for. By rounding it may be one
    /// less.
    pub(super) fn most_steps(&self, method: Method) -> u32 {
        (self.budget.frame / self.costs.of_frame(Stepping { method, steps: 1 })) as u32
    }
}
