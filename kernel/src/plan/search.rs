//! From coarse steps to fine ones until something is right to the end.
//!
//! All of it is done in pieces that a busy caller can afford: a few steps of one motion, a comparison, a new step size.

use super::candidate::Candidate;
use super::cost::{Budget, Costs, FIRST_STEP, MOST_STEPS, RESOLVING, Way, admissible_step, steps_to_frame};
use super::error::{Limit, PlanError};
use super::pass::Pass;
use super::problem::Problem;
use crate::error::{Error, Parameter};
use crate::pendulum::Pendulum;
use crate::table::Method;

/// The cheapest method found, and what it brings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Plan {
    /// The method to compute the motion by.
    pub method: Method,
    /// Steps to a frame; 0 for the closed form.
    pub steps: u32,
    /// The step size, s; 0 for the closed form.
    pub dt: f64,
    /// The largest error expected until the horizon, over the tolerance.
    pub error: f32,
    /// What computing a frame costs, without drawing it; never more than the budget.
    pub cost: f32,
    /// Until when every frame is predicted to be right to the tolerance, s: the time of the last of them. No proof: of 2,000
    /// scenes one may be wrong a little earlier (the repository's test `plan_study`).
    pub horizon: f64,
    /// What ends the horizon.
    pub limit: Limit,
    /// What planning has cost; never more than the budget.
    pub spent: f32,
}

/// A comparison with 64 bits is made only if the planning budget covers this many times the horizon found so far.
const LONGER: f32 = 1.25;

/// A search under way; [`advance`](Self::advance) it until there is a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    problem: Problem,
    costs: Costs,
    budget: Budget,
    /// Steps to a frame by [`Method::Extrapolation10Fixed64`] that resolve the motion, if its numbers take it.
    exact: Option<u32>,
    /// Those that a frame pays for, and what ends their horizon.
    fine: Option<(u32, Limit)>,
    /// What is looked at.
    way: Way,
    /// Made by a piece of its own.
    pass: Option<Pass>,
    /// Frames compared with these steps.
    frame: u32,
    /// Whether the motions of the pass are prepared.
    prepared: bool,
    /// Whether the next frame is within the budget, and is being computed.
    begun: bool,
    /// The only one that counts, if it is given.
    given: Option<Way>,
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
        let admissible = admissible_step(&problem.pendulum, &problem.start)?;
        problem.check()?;
        costs.check()?;
        budget.check()?;
        let fine = |longest: f64, frame: f32| {
            let Problem { pendulum, start, rate, .. } = problem;
            Way::fixed64(pendulum, start, *rate, longest * admissible, costs, frame).map(|way| way.steps)
        };
        let exact = fine(RESOLVING, f32::INFINITY);
        let affordable = |steps: &u32| costs.of_frame(Method::Extrapolation10Fixed64, *steps) <= budget.frame;
        let coarser = || fine(FIRST_STEP, budget.frame).map(|steps| (steps, Limit::Budget));
        let method = if costs.fixed32 < costs.direction { Method::Rk4Fixed32 } else { Method::Rk4F32Direction };
        let steps = steps_to_frame(method, problem.rate, FIRST_STEP * admissible);
        Ok(Self {
            problem: *problem,
            costs: *costs,
            budget: *budget,
            exact,
            fine: exact.filter(affordable).map(|steps| (steps, Limit::Growth)).or_else(coarser),
            way: Way { method, steps },
            pass: None,
            frame: 0,
            prepared: false,
            begun: false,
            given: None,
            spent: 0.0,
            best: None,
        })
    }

    /// For no method but this one, with `steps` steps to a frame: how long it is right, whatever it costs; a horizon of 0
    /// says that no frame is. The closed form has no steps; those given are the ones of the run that it is compared with.
    ///
    /// Refuses what [`new`](Self::new) refuses, and a method that is none of [`Method::DRAWN`]. No steps count as one.
    #[inline(never)]
    #[doc(hidden)]
    pub fn of(
        method: Method,
        steps: u32,
        problem: &Problem,
        costs: &Costs,
        budget: &Budget,
    ) -> Result<Self, PlanError> {
        if !Method::DRAWN.contains(&method) {
            return Err(Error::NotDrawn { method }.into());
        }
        let mut search = Self::new(problem, costs, budget)?;
        let given = Way { method, steps: if steps > 0 { steps } else { 1 } };
        search.way.steps = given.steps;
        search.way.method = match method {
            Method::ClosedFormF32 => search.way.method,
            Method::Rk4F32DirectionPlain => Method::Rk4F32Direction,
            method => method,
        };
        (search.given, search.best, search.budget.frame) = (Some(given), Some(Candidate::new(given)), f32::INFINITY);
        Ok(search)
    }

    /// Does a piece of the search: steps of one motion that together cost no more than `cost`, or a single one that does;
    /// or the preparation of a motion; or a comparison. The plan, when it is found.
    ///
    /// Refuses what [`Pendulum::run`](crate::Pendulum::run) refuses: a pendulum out of the range of `f32`. And if nothing within the
    /// budgets is right in any frame, that is the error at the end of the search.
    pub fn advance(&mut self, cost: f32) -> Result<Option<Plan>, PlanError> {
        let Some(pass) = &mut self.pass else { return self.make() };
        if !self.begun {
            let next = if self.prepared { pass.cost(&self.costs) } else { self.costs.preparation };
            if self.spent + next > self.budget.planning {
                self.keep_best();
                return self.plan(Limit::Planning).map(Some);
            }
            if !self.prepared {
                return self.prepare();
            }
            self.begun = true;
        }
        let spent = pass.advance(&self.costs, cost);
        if spent > 0.0 {
            self.spent += spent;
            return Ok(None);
        }
        self.begun = false;
        self.frame += 1;
        pass.compare(self.problem.time(self.frame));
        let at_end = self.frame >= self.problem.frames();
        if !at_end && pass.candidates().iter().any(|candidate| !candidate.failed) {
            return Ok(None);
        }
        self.keep_best();
        if self.best.is_some_and(|best| best.right >= self.problem.frames()) {
            return self.plan(Limit::End).map(Some);
        }
        let times = self.pass.as_ref().and_then(Pass::finer);
        self.go_on(times)
    }

    /// A form takes no steps so long, or no motion of so high an energy, or no such pendulum: finer ones, or `f32`, may.
    fn refused(&mut self, error: Error) -> Result<Option<Plan>, PlanError> {
        let is_step = matches!(error, Error::TooLarge { parameter: Parameter::Dt, .. });
        match self.way.method {
            Method::Rk4F32Direction => Err(error.into()),
            Method::Rk4Fixed32 if !is_step && self.given.is_none() => {
                self.begin(Way { method: Method::Rk4F32Direction, ..self.way });
                Ok(None)
            }
            _ => self.go_on(Some(2)),
        }
    }

    fn begin(&mut self, way: Way) {
        (self.way, self.pass, self.frame, self.begun, self.prepared) = (way, None, 0, false, false);
    }

    /// Makes the pass, which costs as much as to prepare a motion.
    #[inline(never)] // it stands on the stack
    fn make(&mut self) -> Result<Option<Plan>, PlanError> {
        if self.spent + self.costs.preparation > self.budget.planning {
            return self.plan(Limit::Planning).map(Some);
        }
        self.spent += self.costs.preparation;
        let Self { way, costs, budget, .. } = *self;
        let beside = self.beside();
        let start = Pendulum::new(&self.problem.pendulum)?.to_state(&self.problem.start);
        let pass = self.pass.insert(Pass::new(way, &self.problem, &start, beside));
        pass.retain(|one| self.given.map_or(one.cost(&costs) <= budget.frame, |given| one.way == given));
        Ok(None)
    }

    /// In 32 bits: steps of a run in 64 bits to compare with, if planning can pay for them as long as the next pass may last.
    fn beside(&self) -> Option<u32> {
        let (frames, right) = (self.problem.frames() as f32, self.best.map_or(0, |best| best.right));
        let longer = LONGER * right as f32;
        let frames = if 0.0 < longer && longer < frames { longer } else { frames };
        let left = (self.budget.planning - self.spent) / frames;
        let affordable = |&exact: &u32| Pass::cost_beside(&self.costs, self.way, exact) <= left;
        self.exact.filter(|_| self.way.method != Method::Extrapolation10Fixed64).filter(affordable)
    }

    fn prepare(&mut self) -> Result<Option<Plan>, PlanError> {
        match self.pass.as_mut().map_or(Ok(false), Pass::prepare) {
            Ok(true) => self.spent += self.costs.preparation,
            Ok(false) => self.prepared = true,
            Err(error) => return self.refused(error),
        }
        Ok(None)
    }

    /// Whether the next piece prepares a motion, which takes longer than any other.
    #[doc(hidden)]
    #[must_use]
    pub fn is_preparing(&self) -> bool {
        self.pass.is_none() || !self.prepared
    }

    fn candidates(&self) -> &[Candidate] {
        self.pass.as_ref().map_or(&[], |pass| pass.candidates())
    }

    /// With finer steps, if there is anything finer to try.
    fn go_on(&mut self, times: Option<u32>) -> Result<Option<Plan>, PlanError> {
        let limit = if self.given.is_some() { Some(Limit::Method) } else { self.refine(times) };
        limit.map(|limit| self.plan(limit)).transpose()
    }

    /// What planning has cost so far.
    #[doc(hidden)]
    #[must_use]
    pub fn spent(&self) -> f32 {
        self.spent
    }

    /// Until when `way` has been found right so far, s. In 64 bits, with steps that resolve the motion, it is so wherever any
    /// other is.
    #[doc(hidden)]
    #[must_use]
    pub fn horizon(&self, way: Way) -> f64 {
        let resolves = |(steps, limit)| limit == Limit::Growth && way.steps >= steps;
        let has_longest_horizon = way.method == Method::Extrapolation10Fixed64 && self.fine.is_some_and(resolves);
        let looked_at = self.candidates().iter().chain(&self.best);
        self.problem.time(looked_at.fold(0, |right, candidate| right.max(candidate.right_of(way, has_longest_horizon))))
    }

    /// Goes on with the method of a plan that was right to its end, for `seconds` longer; [`Self::advance`] gives the plan
    /// anew then.
    #[doc(hidden)]
    pub fn extend(&mut self, seconds: f64) {
        if let (Some(best), Some(pass)) = (self.best, &mut self.pass) {
            pass.retain(|one| one.way == best.way);
            self.given = Some(best.way);
            self.problem.duration += seconds;
            self.budget.planning = f32::INFINITY;
        }
    }

    /// Takes the best of the candidates so far.
    fn keep_best(&mut self) {
        let Some(pass) = &self.pass else { return };
        for candidate in *pass.candidates() {
            if self.is_better(&candidate) {
                self.best = Some(candidate);
            }
        }
    }

    /// Goes on to finer steps, or to 64 bits where rounding is what limits, or where they cost less; what forbids it, if
    /// anything does.
    fn refine(&mut self, times: Option<u32>) -> Option<Limit> {
        let Way { method, steps } = self.way;
        if method == Method::Extrapolation10Fixed64 {
            return Some(self.fine.map_or(Limit::Budget, |(_, limit)| limit));
        }
        if times.is_none() && self.pass.as_ref().is_some_and(|pass| !pass.is_beside_64_bits) && self.beside().is_some()
        {
            self.begin(self.way);
            return None;
        }
        let finer = times.map(|times| steps.saturating_mul(times)).filter(|&steps| steps <= MOST_STEPS);
        let cost = |method, steps| self.costs.of_frame(method, steps);
        let fine = self.fine.map(|(steps, _)| (Method::Extrapolation10Fixed64, steps));
        let fine = fine.filter(|&(fine, steps)| finer.is_none_or(|finer| cost(fine, steps) <= cost(method, finer)));
        let affordable = finer.filter(|&finer| cost(method, finer) <= self.budget.frame).map(|finer| (method, finer));
        let Some((method, steps)) = fine.or(affordable) else { return Some(Limit::Budget) };
        self.begin(Way { method, steps });
        None
    }

    /// Whether `candidate` goes so much farther than the best so far, or as far and cheaper.
    #[inline(never)] // one copy
    fn is_better(&self, candidate: &Candidate) -> bool {
        let cost = |candidate: &Candidate| candidate.cost(&self.costs);
        if candidate.right == 0 || cost(candidate) > self.budget.frame {
            return false;
        }
        self.best.is_none_or(|best| {
            let is_it = candidate.way == best.way;
            let reaches_end = candidate.right >= self.problem.frames() && best.right < candidate.right;
            let cheaper = candidate.right >= best.right && cost(candidate) < cost(&best);
            reaches_end || candidate.outlasts(&best) || cheaper || is_it && candidate.right > best.right
        })
    }

    /// The best candidate as a plan, if there is one.
    #[inline(never)] // one copy
    fn plan(&self, limit: Limit) -> Result<Plan, PlanError> {
        let Some(best) = self.best else {
            // To plan for longer would help nothing of which a frame costs too much.
            let is_open = |pass: &Pass| pass.candidates().iter().any(|one| !one.failed);
            let open = self.pass.as_ref().is_none_or(is_open);
            let limit = if limit == Limit::Planning && !open { Limit::Budget } else { limit };
            return Err(PlanError::NoMethod { limit, spent: self.spent });
        };
        let Way { method, steps } = best.way;
        let steps = if method == Method::ClosedFormF32 { 0 } else { steps };
        let rate = f64::from(self.problem.rate);
        Ok(Plan {
            method,
            steps,
            dt: if steps == 0 { 0.0 } else { 1.0 / (rate * f64::from(steps)) },
            error: best.error,
            cost: best.cost(&self.costs),
            horizon: if limit == Limit::End { self.problem.duration } else { self.problem.time(best.right) },
            limit,
            spent: self.spent,
        })
    }
}
