//! From coarse steps to fine ones until something is right to the end.
//!
//! All of it is done in pieces that a busy caller can afford: a few steps of one motion, a comparison, a new step size.

use super::candidate::Candidate;
use super::cost::{FIRST_STEP, MOST_STEPS, RESOLVING, admissible_step, steps_to_frame};
use super::pass::Pass;
use super::{Budget, Costs, Limit, Plan, PlanError, Problem, Stepping};
use crate::error::{Error, Parameter};
use crate::table::Method;

/// A comparison with 64 bits is made only if the planning budget covers this many times the horizon found so far.
const LONGER: f32 = 1.25;

/// A search under way; [`advance`](Self::advance) it until there is a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    problem: Problem,
    costs: Costs,
    budget: Budget,
    /// By [`Method::Extrapolation10Fixed64`] in steps that resolve the motion, if its numbers take it.
    exact: Option<Stepping>,
    /// In those that a frame pays for, and what ends their horizon.
    fine: Option<(Stepping, Limit)>,
    /// What is looked at.
    stepping: Stepping,
    /// Made by a piece of its own.
    pass: Option<Pass>,
    /// Frames compared with these steps.
    frame: u32,
    /// Whether the motions of the pass are prepared.
    prepared: bool,
    /// Whether the next frame is within the budget, and is being computed.
    begun: bool,
    /// The only one that counts, if it is given.
    given: Option<Stepping>,
    spent: f32,
    best: Option<Candidate>,
}

impl Search {
    /// For the cheapest method.
    ///
    /// Refuses a problem without a tolerance, a duration or a rate, a pendulum that the kernel refuses, and costs or
    /// budgets that are not positive.
    #[inline(never)] // a search stands on the stack while it is made
    pub fn new(problem: &Problem, costs: &Costs, budget: &Budget) -> Result<Self, PlanError> {
        let admissible = admissible_step(problem)?;
        problem.check(costs, budget)?;
        let fine = |longest: f64, frame: f32| {
            Stepping::fixed64(problem, longest * admissible, costs, frame)
        };
        let exact = fine(RESOLVING, f32::INFINITY);
        let affordable = |stepping: &Stepping| costs.of_frame(*stepping) <= budget.frame;
        let coarser = || fine(FIRST_STEP, budget.frame).map(|stepping| (stepping, Limit::Budget));
        let method = if costs.fixed32 < costs.direction {
            Method::Rk4Fixed32
        } else {
            Method::Rk4F32Direction
        };
        let steps = steps_to_frame(method, problem.rate, FIRST_STEP * admissible);
        Ok(Self {
            problem: *problem,
            costs: *costs,
            budget: *budget,
            exact,
            fine: exact
                .filter(affordable)
                .map(|stepping| (stepping, Limit::Growth))
                .or_else(coarser),
            stepping: Stepping { method, steps },
            pass: None,
            frame: 0,
            prepared: false,
            begun: false,
            given: None,
            spent: 0.0,
            best: None,
        })
    }

    /// For this method and these steps alone: how long it is right, whatever it costs; a horizon of 0 says that no frame is. The closed form has no
    /// steps; those given are the ones of the run that it is compared with.
    ///
    /// Refuses what [`new`](Self::new) refuses, and a method that is none of [`Method::DRAWN`]. No steps count as one.
    #[inline(never)]
    #[doc(hidden)]
    pub fn of(
        stepping: Stepping,
        problem: &Problem,
        costs: &Costs,
        budget: &Budget,
    ) -> Result<Self, PlanError> {
        if !Method::DRAWN.contains(&stepping.method) {
            return Err(Error::NotDrawn {
                method: stepping.method,
            }
            .into());
        }
        let mut search = Self::new(problem, costs, budget)?;
        let given = Stepping {
            steps: if stepping.steps > 0 {
                stepping.steps
            } else {
                1
            },
            ..stepping
        };
        search.stepping.steps = given.steps;
        search.stepping.method = match given.method {
            Method::ClosedFormF32 => search.stepping.method,
            Method::Rk4F32DirectionPlain => Method::Rk4F32Direction,
            method => method,
        };
        (search.given, search.best, search.budget.frame) =
            (Some(given), Some(Candidate::new(given)), f32::INFINITY);
        Ok(search)
    }

    /// Does a piece of the search: steps of one motion that together cost no more than `cost`, or a single one that does;
    /// or the preparation of a motion; or a comparison. The plan, when it is found.
    ///
    /// Refuses what [`Pendulum::run`](crate::Pendulum::run) refuses: a pendulum out of the range of `f32`. And if nothing within the
    /// budgets is right in any frame, that is the error at the end of the search.
    pub fn advance(&mut self, cost: f32) -> Result<Option<Plan>, PlanError> {
        self.piece(cost)?.map(|limit| self.plan(limit)).transpose()
    }

    /// Does a piece; what ends the search, if anything does.
    fn piece(&mut self, cost: f32) -> Result<Option<Limit>, Error> {
        let preparation = self.costs.preparation;
        if !self.begun {
            let next = self.pass.as_mut().filter(|_| self.prepared);
            let next = next.map_or(preparation, |pass| pass.cost(&self.costs));
            if self.spent + next > self.budget.planning {
                self.keep_best();
                return Ok(Some(Limit::Planning));
            }
        }
        let Some(pass) = &mut self.pass else {
            self.spent += preparation;
            self.make();
            return Ok(None);
        };
        if !self.prepared {
            match pass.prepare(&self.problem) {
                Ok(true) => self.spent += preparation,
                Ok(false) => self.prepared = true,
                Err(error) => return self.refused(error),
            }
            return Ok(None);
        }
        let spent = pass.advance(&self.costs, cost);
        self.spent += spent;
        self.begun = spent > 0.0;
        if self.begun {
            return Ok(None);
        }
        self.frame += 1;
        pass.compare(self.problem.time(self.frame));
        let at_end = self.frame >= self.problem.frames();
        if !at_end && pass.candidates.iter().any(|candidate| !candidate.failed) {
            return Ok(None);
        }
        let times = pass.finer();
        self.keep_best();
        let is_right = self
            .best
            .is_some_and(|best| best.right >= self.problem.frames());
        Ok(if is_right {
            Some(Limit::End)
        } else {
            self.refine(times)
        })
    }

    /// A form takes no steps so long, or no motion of so high an energy, or no such pendulum: finer ones, or `f32`, may.
    fn refused(&mut self, error: Error) -> Result<Option<Limit>, Error> {
        let is_step = matches!(
            error,
            Error::TooLarge {
                parameter: Parameter::Dt,
                ..
            }
        );
        let is_beside = |given: Stepping| given.method == Method::ClosedFormF32;
        match self.stepping.method {
            Method::Rk4F32Direction => Err(error),
            Method::Rk4Fixed32 if self.given.map_or(!is_step, is_beside) => {
                self.begin(Stepping {
                    method: Method::Rk4F32Direction,
                    ..self.stepping
                });
                Ok(None)
            }
            _ => Ok(self.refine(Some(2))),
        }
    }

    fn begin(&mut self, stepping: Stepping) {
        (self.stepping, self.pass, self.frame, self.prepared) = (stepping, None, 0, false);
    }

    /// Makes the pass, which costs as much as to prepare a motion.
    #[inline(never)] // it stands on the stack
    fn make(&mut self) {
        let Self {
            stepping,
            costs,
            budget,
            given,
            ..
        } = *self;
        let beside = self.beside();
        let pass = self.pass.insert(Pass::new(stepping, &self.problem, beside));
        pass.retain(|one| {
            given.map_or(costs.of_frame(one.stepping) <= budget.frame, |given| {
                one.stepping == given
            })
        });
    }

    /// In 32 bits: a run in 64 bits to compare with, if planning can pay for it as long as the next pass may last.
    fn beside(&self) -> Option<Stepping> {
        let (frames, right) = (
            self.problem.frames() as f32,
            self.best.map_or(0, |best| best.right),
        );
        let longer = LONGER * right as f32;
        let frames = if 0.0 < longer && longer < frames {
            longer
        } else {
            frames
        };
        let left = (self.budget.planning - self.spent) / frames;
        let affordable =
            |&exact: &Stepping| Pass::cost_beside(&self.costs, self.stepping, exact) <= left;
        self.exact
            .filter(|exact| self.stepping.method != exact.method)
            .filter(affordable)
    }

    /// Whether the next piece prepares a motion, which takes longer than any other.
    #[doc(hidden)]
    #[must_use]
    pub fn is_preparing(&self) -> bool {
        self.pass.is_none() || !self.prepared
    }

    /// What planning has cost so far.
    #[doc(hidden)]
    #[must_use]
    pub fn spent(&self) -> f32 {
        self.spent
    }

    /// Until when `stepping` has been found right so far, s. In 64 bits, with steps that resolve the motion, it is so wherever any
    /// other is.
    #[doc(hidden)]
    #[must_use]
    pub fn horizon(&self, stepping: Stepping) -> f64 {
        let is_finer =
            |(fine, limit): (Stepping, _)| limit == Limit::Growth && stepping.steps >= fine.steps;
        let resolves =
            stepping.method == Method::Extrapolation10Fixed64 && self.fine.is_some_and(is_finer);
        let is_same = |one: &Stepping| {
            one.steps == stepping.steps || stepping.method == Method::ClosedFormF32
        };
        let is_shown = |one: &&Candidate| {
            resolves || one.stepping.method == stepping.method && is_same(&one.stepping)
        };
        let looked_at = self
            .pass
            .iter()
            .flat_map(|pass| &pass.candidates)
            .chain(&self.best);
        self.problem.time(
            looked_at
                .filter(is_shown)
                .map(|one| one.right)
                .max()
                .unwrap_or(0),
        )
    }

    /// Goes on with the method of a plan that was right to its end, for `seconds` longer; [`Self::advance`] gives the plan
    /// anew then.
    #[doc(hidden)]
    pub fn extend(&mut self, seconds: f64) {
        if let (Some(best), Some(pass)) = (self.best, &mut self.pass) {
            pass.retain(|one| one.stepping == best.stepping);
            self.given = Some(best.stepping);
            self.problem.duration += seconds;
            self.budget.planning = f32::INFINITY;
        }
    }

    /// Goes on to finer steps, or to 64 bits where rounding is what limits, or where they cost less; what forbids it, if
    /// anything does.
    fn refine(&mut self, times: Option<u32>) -> Option<Limit> {
        if self.given.is_some() {
            return Some(Limit::Method);
        }
        if self.stepping.method == Method::Extrapolation10Fixed64 {
            return Some(self.fine.map_or(Limit::Budget, |(_, limit)| limit));
        }
        if times.is_none()
            && self
                .pass
                .as_ref()
                .is_some_and(|pass| !pass.is_beside_64_bits)
            && self.beside().is_some()
        {
            self.begin(self.stepping);
            return None;
        }
        let cost = |stepping| self.costs.of_frame(stepping);
        let finer = times.map(|times| Stepping {
            steps: self.stepping.steps.saturating_mul(times),
            ..self.stepping
        });
        let finer = finer.filter(|finer| finer.steps <= MOST_STEPS);
        let fine = self.fine.map(|(fine, _)| fine);
        let fine = fine.filter(|&fine| finer.is_none_or(|finer| cost(fine) <= cost(finer)));
        let affordable = finer.filter(|&finer| cost(finer) <= self.budget.frame);
        let Some(stepping) = fine.or(affordable) else {
            return Some(Limit::Budget);
        };
        self.begin(stepping);
        None
    }

    /// Takes the best of the candidates so far.
    fn keep_best(&mut self) {
        for candidate in self.pass.iter().flat_map(|pass| pass.candidates) {
            if self.is_better(&candidate) {
                self.best = Some(candidate);
            }
        }
    }

    /// Whether `candidate` goes so much farther than the best so far, or as far and cheaper.
    #[inline(never)] // one copy
    fn is_better(&self, candidate: &Candidate) -> bool {
        let is_better = |best: Candidate| {
            let is_it = candidate.stepping == best.stepping;
            let reaches_end =
                candidate.right >= self.problem.frames() && best.right < candidate.right;
            let is_cheaper =
                self.costs.of_frame(candidate.stepping) < self.costs.of_frame(best.stepping);
            let cheaper = candidate.right >= best.right && is_cheaper;
            reaches_end
                || candidate.has_longer_horizon(&best)
                || cheaper
                || is_it && candidate.right > best.right
        };
        candidate.right > 0 && self.best.is_none_or(is_better)
    }

    /// The best candidate as a plan, if there is one.
    #[inline(never)] // one copy
    fn plan(&self, limit: Limit) -> Result<Plan, PlanError> {
        let Some(best) = self.best else {
            // To plan for longer would help nothing of which a frame costs too much.
            let open = self
                .pass
                .as_ref()
                .is_none_or(|pass| pass.candidates.iter().any(|one| !one.failed));
            let limit = if limit == Limit::Planning && !open {
                Limit::Budget
            } else {
                limit
            };
            return Err(PlanError::NoMethod {
                limit,
                spent: self.spent,
            });
        };
        let Stepping { method, steps } = best.stepping;
        let steps = if method == Method::ClosedFormF32 {
            0
        } else {
            steps
        };
        let rate = f64::from(self.problem.rate);
        Ok(Plan {
            method,
            steps,
            dt: if steps == 0 {
                0.0
            } else {
                1.0 / (rate * f64::from(steps))
            },
            error: best.error,
            cost: self.costs.of_frame(best.stepping),
            horizon: if limit == Limit::End {
                self.problem.duration
            } else {
                self.problem.time(best.right)
            },
            limit,
            spent: self.spent,
        })
    }
}
