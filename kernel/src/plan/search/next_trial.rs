//! The choice of the next trial, or of the limit that ends a search.

use super::affordable::{MARGINS, first_steps};
use super::{Goal, Purpose, Search, SearchState};
use crate::error::{Error, Parameter};
use crate::plan::candidate::Candidate;
use crate::plan::cost::{MOST_STEPS, Pair};
use crate::plan::trial::{Judges, MOST_FINER_RUNS, Trial};
use crate::plan::{Limit, Stepping};
use crate::table::Method;

impl Search {
    /// Keeps the best candidate of the trial and begins the next trial. Returns the limit that ends
    /// the search, if one does.
    pub(super) fn end_trial(&mut self) -> Option<Limit> {
        self.keep_best();
        let purpose = core::mem::replace(&mut self.purpose, Purpose::Horizon);
        let reaches_end = |best: &Candidate| best.accurate_frames >= self.problem.frames();
        if self.goal.best().is_some_and(reaches_end) {
            return Some(Limit::End);
        }

        // After fast growth, try 64 bits. Otherwise repeat a trial that measured only the growth.
        if let Some(in_64_bits) = self.in_64_bits_after_growth() {
            self.begin_trial(in_64_bits);
            return None;
        }
        if purpose == Purpose::Growth {
            self.begin_trial(self.stepping);
            self.purpose = Purpose::HorizonAfterGrowth;
            return None;
        }

        let factor = match &self.state {
            SearchState::NoTrial => None,
            SearchState::Trying { trial, .. } => trial.refinement(),
        };
        // Repeat the trial with more finer runs. `begin_trial` resets their smallest number.
        if let Some(number) = self.more_finer_runs() {
            self.begin_trial(self.stepping);
            self.least_finer_runs = number;
            return None;
        }
        let limit = self.refine(factor)?;

        // With a larger planning budget the trial would be repeated with more finer runs. The
        // planning budget is then the limit, not the frame budget.
        let is_rough = match &self.state {
            SearchState::NoTrial => false,
            SearchState::Trying { trial, .. } => trial.is_rough() && self.may_improve_plan(),
        };
        Some(match limit {
            Limit::Budget if is_rough => Limit::Planning,
            limit => limit,
        })
    }

    /// Returns the steps in 64 bits that follow a trial with three finer runs, which is over: if
    /// errors have grown fast, as in a chaotic motion, if 32 bits have failed in the first half of
    /// the problem, if a frame can pay for 64 bits, and if planning can pay for them for 2.75 times
    /// the known horizon.
    ///
    /// Returns `None` as well if one method is evaluated, or if 32 bits have failed in the first
    /// 1/16 of the problem. A heavy bob 2 can make errors grow fast for moments, also in a regular
    /// motion.
    pub(super) fn in_64_bits_after_growth(&self) -> Option<Stepping> {
        let SearchState::Trying { trial, .. } = &self.state else {
            return None;
        };
        let frames = trial.frames_in_32_bits();
        let is_in_range = self.fails_early(trial) && frames > self.problem.frames() / 16;
        let is_measured = trial.finer_runs() == MOST_FINER_RUNS;
        let is_evaluation = matches!(self.goal, Goal::Evaluate { .. });
        if is_evaluation || !is_in_range || !is_measured || !trial.errors_grow_fast() {
            return None;
        }

        let in_64_bits = self.in_64_bits()?;
        self.can_pay_for_64_bits(in_64_bits).then_some(in_64_bits)
    }

    /// Continues the search after a method has refused the motion with `error`.
    ///
    /// If fixed point refuses a step as too long, the next trial takes twice as many steps. If a
    /// frame cannot pay for these but can pay for `f32`, the search continues in `f32`, which
    /// accepts longer steps, and fixed point is postponed. A motion or a pendulum that is out of
    /// the range of fixed point may be in the range of `f32`, which is the last resort.
    ///
    /// Returns the limit that ends the search, if one does, and the error if `f32` has refused the
    /// motion and no frame is known to be accurate.
    pub(super) fn after_refusal(&mut self, error: Error) -> Result<Option<Limit>, Error> {
        let is_step_too_long = matches!(
            error,
            Error::TooLarge {
                parameter: Parameter::Dt,
                ..
            }
        );

        // Fixed point after `f32` was postponed.
        let is_after_f32 = self.method_in_32_bits != Method::Rk4Fixed32;

        // Steps in `f32` may be longer than in fixed point, but cost more. An evaluation may
        // replace its method only if it evaluates the closed form.
        let may_use_f32 = !is_after_f32
            && match &self.goal {
                Goal::FindBest { .. } => !is_step_too_long || self.can_only_pay_for_f32(),
                Goal::Evaluate { only } => only.stepping.method == Method::ClosedFormF32,
            };

        // After fixed point try `f32`, which nothing follows. In other cases try finer steps.
        match (self.stepping.method, &self.goal) {
            (Method::Rk4F32Direction, Goal::FindBest { best: Some(_) }) => Ok(Some(Limit::Budget)),
            (Method::Rk4F32Direction, _) => Err(error),
            (Method::Rk4Fixed32, _) if may_use_f32 => {
                self.is_fixed_point_postponed = is_step_too_long;
                self.change_to_f32();
                Ok(None)
            }
            // The closed form is also measured if a frame cannot pay for the steps of its trial.
            // Fixed point that was postponed has no other purpose.
            (Method::Rk4Fixed32, Goal::FindBest { best })
                if (best.is_none() || is_after_f32) && self.stepping.steps < MOST_STEPS =>
            {
                self.begin_trial(Stepping {
                    steps: 2 * self.stepping.steps,
                    ..self.stepping
                });
                Ok(None)
            }
            _ => Ok(self.refine(Some(2))),
        }
    }

    /// Begins a trial in finer steps, in 64 bits or, without these, in `f32`, or repeats the last
    /// one with a reference. Returns the limit that forbids all of these, if one does.
    ///
    /// `factor` multiplies the step count. It is `None` if finer steps do not seem to help.
    pub(super) fn refine(&mut self, factor: Option<u32>) -> Option<Limit> {
        if let Goal::Evaluate { .. } = self.goal {
            return Some(Limit::Method);
        }
        // Without a reference the bounds are rough. Repeat the trial if planning can now pay for
        // one.
        let (has_reference, has_tried_64_bits) = match &self.state {
            SearchState::NoTrial => (false, false),
            SearchState::Trying { trial, .. } => (trial.has_reference(), trial.tries_64_bits),
        };
        let is_rough = !has_reference && matches!(self.state, SearchState::Trying { .. });
        if factor.is_none() && is_rough && self.affordable_reference().is_some() {
            self.begin_trial(self.stepping);
            return None;
        }

        if let Some(finer) = self.finer(factor) {
            self.begin_trial(finer);
            return None;
        }
        let Some(in_64_bits) = self.in_64_bits() else {
            return self.try_last_resort();
        };
        if has_tried_64_bits || self.stepping_is_in_64_bits() {
            let limit = self.limit_in_64_bits(in_64_bits);
            if limit.is_some() {
                return limit;
            }
        }
        self.begin_trial(in_64_bits);
        None
    }

    /// Begins the next trial in 32 bits if a frame cannot pay for 64 bits, or if these refuse the
    /// motion: `f32` after fixed point, then finer steps of `f32`, then fixed point that was
    /// postponed. Returns the limit if none of these is left.
    ///
    /// Finer steps of `f32` are tried even if rounding seems to be the larger error, as long as
    /// they help. In steps that do not resolve the motion, the errors of finer runs are as
    /// irregular as rounding errors.
    ///
    /// Fixed point is not refined further, because `f32` has more digits if the masses or lengths
    /// are very unlike.
    fn try_last_resort(&mut self) -> Option<Limit> {
        // Finer steps have helped unless the best known candidate has coarser ones.
        let best = self.goal.best().map(|best| best.stepping.steps);
        let has_helped = best.is_none_or(|steps| steps >= self.stepping.steps);
        let finer = match &self.state {
            SearchState::Trying { trial, .. } if self.stepping_is_in_f32() && has_helped => {
                self.finer(Some(trial.usual_factor()))
            }
            _ => None,
        };
        if let Some(finer) = finer {
            self.begin_trial(finer);
            return None;
        }

        let in_f32 = self.first_in(Method::Rk4F32Direction);
        let can_pay = self.costs.of_frame(in_f32) <= self.budget.frame;
        if self.method_in_32_bits == Method::Rk4Fixed32 && can_pay {
            self.change_to_f32();
        } else if self.is_fixed_point_postponed {
            self.is_fixed_point_postponed = false;
            self.begin_trial(self.first_in(Method::Rk4Fixed32));
        } else {
            return Some(Limit::Budget);
        }
        None
    }

    /// Begins the first trial in `f32`, which replaces fixed point.
    fn change_to_f32(&mut self) {
        self.method_in_32_bits = Method::Rk4F32Direction;
        self.begin_trial(self.first_in(Method::Rk4F32Direction));
    }

    /// Returns the method and step count of the first trial by `method`, which is in 32 bits. The
    /// evaluation of one method keeps its step count.
    pub(super) fn first_in(&self, method: Method) -> Stepping {
        let steps = match self.goal {
            Goal::FindBest { .. } => first_steps(
                method,
                &self.problem,
                self.admissible,
                &self.costs,
                &self.budget,
            ),
            Goal::Evaluate { .. } => self.stepping.steps,
        };
        Stepping { method, steps }
    }

    /// Returns true if a frame can pay for the steps of the first trial in `f32`, but not for twice
    /// the present steps.
    pub(super) fn can_only_pay_for_f32(&self) -> bool {
        let can_pay = |stepping| self.costs.of_frame(stepping) <= self.budget.frame;
        let finer = Stepping {
            steps: self.stepping.steps.saturating_mul(2),
            ..self.stepping
        };
        can_pay(self.first_in(Method::Rk4F32Direction)) && !can_pay(finer)
    }

    /// Returns the next trial in 32 bits, in `factor` times as many steps or, if a frame cannot pay
    /// for these, in as many as it can pay for. Returns `None` if these are not at least a quarter
    /// more than the finest that the last trial tried, if 64 bits cost no more or have better
    /// prospects, if `factor` is `None` or too large, or if the search is in 64 bits or evaluates
    /// one method.
    pub(super) fn finer(&self, factor: Option<u32>) -> Option<Stepping> {
        if let Goal::Evaluate { .. } = self.goal {
            return None;
        }
        let Stepping { method, steps } = self.stepping;
        let factor = factor?;
        let most = self.most_steps(method);
        let finer = Stepping {
            steps: steps.saturating_mul(factor).min(most),
            method,
        };

        // A factor of 8 follows a trial of 1, 2 and 4 times the steps, a factor of 2 a trial of the
        // steps alone. The finest of these that a frame can pay for was tried.
        let finest = [4, 2]
            .into_iter()
            .filter(|&times| times < factor)
            .map(|times| steps.saturating_mul(times))
            .find(|&tried| tried <= most)
            .unwrap_or(steps);
        let is_finer = finer.steps >= finest.saturating_add(finest.div_ceil(4));

        let cost = self.costs.of_frame(finer);
        let in_64_bits = self.in_64_bits();
        let cost_of_64_bits = match in_64_bits {
            Some(in_64_bits) => self.costs.of_frame(in_64_bits),
            None => f32::INFINITY,
        };
        let is_worth_it = method != Method::Extrapolation10Fixed64
            && is_finer
            && finer.steps <= MOST_STEPS
            && cost <= self.budget.frame
            && cost < cost_of_64_bits;

        // If 32 bits are accurate for less than half of the problem, 64 bits have better prospects.
        // Either they are on trial, or their own trial is next. It is next if planning can pay for
        // it, but not for a trial of finer steps that includes 64 bits. In addition, it must not be
        // too expensive, or finer steps must gain little, so that they rarely reach the end. A
        // first trial must have shown the horizon of 32 bits before.
        let has_better_prospects = match &self.state {
            SearchState::Trying { trial, .. } => {
                let can_pay = |stepping| self.judging_pair(stepping).is_some();
                let is_next = || {
                    self.is_refined()
                        && !can_pay(finer)
                        && in_64_bits.is_some_and(|stepping| {
                            self.judging_pair(stepping).is_some_and(|pair| {
                                let judges = Judges::Reference(pair);
                                let cost = Trial::cost(&self.costs, stepping, judges);
                                trial.finer_steps_gain_little()
                                    || !self.is_too_expensive(finer, cost)
                            })
                        })
                };
                self.fails_early(trial) && (trial.tries_64_bits || is_worth_it && is_next())
            }
            SearchState::NoTrial => false,
        };
        (is_worth_it && !has_better_prospects).then_some(finer)
    }

    /// Returns the number of finer runs to repeat the trial with: the largest that planning can pay
    /// for.
    ///
    /// If planning can now pay for a reference, it is one more than the trial had; the repeated
    /// trial then takes the reference. Returns `None` if the trial had three finer runs or a
    /// reference, if no candidate has failed, if planning cannot pay for more, if finer steps are
    /// to be tried instead, if one method is evaluated, or if there is no trial.
    pub(super) fn more_finer_runs(&self) -> Option<u8> {
        let SearchState::Trying { trial, .. } = &self.state else {
            return None;
        };
        let is_evaluation = matches!(self.goal, Goal::Evaluate { .. });
        let has_failed = trial.candidates.iter().any(Candidate::has_failed);
        if is_evaluation || !trial.is_rough() || !has_failed {
            return None;
        }
        let number = trial.finer_runs();

        // Two finer runs, unlike a single one, show whether truncation is the larger error. If it
        // is, try finer steps instead.
        let [.., margin] = MARGINS;
        let known = self.goal.best().map_or(0, |best| best.accurate_frames);
        let frames = margin * known.max(1) as f32;
        let has_finer = || {
            let finer = self.finer(Some(2));
            finer.is_some_and(|finer| self.can_pay(finer, number, frames))
        };
        if number > 1 && !trial.is_limited_by_rounding() && has_finer() {
            return None;
        }

        // If planning can now pay for a reference, the repeated trial takes that instead.
        if self.affordable_reference().is_some() {
            return Some(number + 1);
        }
        let mut numbers = (number + 1..=MOST_FINER_RUNS).rev();
        numbers.find(|&number| self.can_pay(self.stepping, number, frames))
    }

    /// Returns true if the trial, or a better measurement of it, may improve the plan. Fixed point
    /// after `f32` was postponed, and only measures the closed form.
    pub(super) fn may_improve_plan(&self) -> bool {
        let is_postponed = self.stepping.method == Method::Rk4Fixed32
            && self.method_in_32_bits != Method::Rk4Fixed32;
        match &self.goal {
            Goal::FindBest { best: Some(best) } if is_postponed => {
                best.stepping.method == Method::ClosedFormF32
            }
            _ => true,
        }
    }

    /// Returns the limit of a search whose candidates in 64 bits have failed, or `None` if a trial
    /// in finer steps is worth it and can be paid for.
    pub(super) fn limit_in_64_bits(&self, in_64_bits: Stepping) -> Option<Limit> {
        let SearchState::Trying { trial, .. } = &self.state else {
            return Some(Limit::Planning);
        };
        let Some(tried) = trial.reference() else {
            return Some(Limit::Budget);
        };

        // The finest pair of all, whether planning can pay for it or not.
        let finest = Pair::all(self.problem.rate, self.admissible, 1, u32::MAX).next();
        let is_affordable = self.costs.of_frame(tried.fine) <= self.budget.frame;
        let is_finest =
            is_affordable && finest.is_some_and(|finest| tried.fine.steps >= finest.fine.steps);

        // Another trial is useless if rounding is the larger error or no finer steps exist.
        if trial.is_limited_by_rounding() || is_finest {
            return Some(Limit::Growth);
        }

        // Another trial is worth it if its steps are finer and planning can pay for it.
        let is_finer = |next: Pair| {
            next.coarse.steps > tried.coarse.steps && next.fine.steps > tried.fine.steps
        };
        if self.pair_within_budget(in_64_bits).is_some_and(is_finer) {
            return None;
        }

        // Name the budget that rules the finer steps out.
        Some(if is_affordable {
            Limit::Planning
        } else {
            Limit::Budget
        })
    }
}
