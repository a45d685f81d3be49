//! From coarse steps to fine ones until something is right to the end.
//!
//! All of it is done in pieces that a busy caller can afford: a few steps of one motion, a comparison, a new step size.

use super::cost::{Budget, Costs, Method};
use super::error::PlanError;
use super::limit::Limit;
use super::pass::{Candidate, Double, Pass, Single};
use super::problem::Problem;
use crate::hamiltonian::Pendulum;
use crate::state::State;

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
    /// Until when every frame is right to the tolerance, s: the time of the last of them.
    pub horizon: f64,
    /// What ends the horizon.
    pub limit: Limit,
    /// What looking ahead has cost; never more than the budget.
    pub spent: f32,
}

/// A costlier method must be right for this much longer to be worth it.
const WORTH: f64 = 1.1;

/// The first step is no longer than this many admissible ones: the fastest rate that the energy allows turns a radian
/// in it. In longer steps two runs could miss alike what neither sees.
const FIRST_STEP: f64 = 4.0;

/// Finer steps than this many to a frame are never tried.
const MOST_STEPS: u32 = 1 << 16;

/// A search under way; [`advance`](Self::advance) it until there is a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Search {
    problem: Problem,
    costs: Costs,
    budget: Budget,
    /// Angles and momenta at the start.
    start: State<f64>,
    /// The coarsest steps to a frame.
    first: u32,
    pass: Pass,
    steps: u32,
    /// Frames compared with these steps.
    frame: u32,
    /// Whether the next frame is within the budget, and is being computed.
    begun: bool,
    /// Whether the method and the step are given.
    given: bool,
    spent: f32,
    best: Option<Candidate>,
}

impl Search {
    /// For the cheapest method.
    ///
    /// Refuses a problem without a tolerance, a duration or a rate, a pendulum that the kernel refuses, and costs or
    /// budgets that are not positive.
    pub fn new(problem: &Problem, costs: &Costs, budget: &Budget) -> Result<Self, PlanError> {
        let pendulum = Pendulum::new(problem.pendulum)?;
        problem.check()?;
        costs.check()?;
        budget.check()?;
        let start = pendulum.to_state(&problem.start);
        let first = first_steps(problem, pendulum.admissible_step(&start)?);
        Ok(Self {
            problem: *problem,
            costs: *costs,
            budget: *budget,
            start,
            first,
            pass: Pass::Single(Single::new(problem, &start, first)),
            steps: first,
            frame: 0,
            begun: false,
            given: false,
            spent: 0.0,
            best: None,
        })
    }

    /// For no method but this one, with `steps` steps to a frame: how long it is right, whatever it costs; a horizon of 0
    /// says that no frame is. The closed form has no steps; those given are the ones of the run that it is compared with.
    ///
    /// Refuses what [`new`](Self::new) refuses. No steps count as one.
    pub fn of(
        method: Method,
        steps: u32,
        problem: &Problem,
        costs: &Costs,
        budget: &Budget,
    ) -> Result<Self, PlanError> {
        let search = Self::new(problem, costs, budget)?;
        let steps = if steps > 0 { steps } else { 1 };
        let mut pass = match method {
            Method::Direction8 => Pass::Double(Double::new(problem, &search.start, steps)),
            _ => Pass::Single(Single::new(problem, &search.start, steps)),
        };
        pass.only(method);
        let budget = Budget { frame: f32::INFINITY, ..*budget };
        Ok(Self { pass, steps, budget, given: true, best: Some(Candidate::new(method, steps)), ..search })
    }

    /// Does a piece of the search: steps of one motion that together cost no more than `cost`, or a single one that does;
    /// or the preparation of a motion; or a comparison. The plan, when it is found.
    ///
    /// Refuses what a [`Form`](crate::form::Form) refuses: a pendulum out of the range of `f32`. And if nothing within the
    /// budgets is right in any frame, that is the error at the end of the search.
    pub fn advance(&mut self, cost: f32) -> Result<Option<Plan>, PlanError> {
        if !self.begun {
            let frame = self.pass.cost(&self.costs);
            if self.spent + frame > self.budget.planning {
                self.keep_best();
                return self.plan(Limit::Planning).map(Some);
            }
            self.spent += frame;
            self.begun = true;
        }
        if self.pass.advance(&self.costs, cost)? {
            return Ok(None);
        }
        self.begun = false;
        self.frame += 1;
        self.pass.compare(self.problem.time(self.frame));
        let at_end = self.frame >= self.problem.frames();
        if !at_end && self.pass.candidates().iter().any(|candidate| !candidate.failed) {
            return Ok(None);
        }
        self.keep_best();
        if self.is_complete() {
            return self.plan(Limit::End).map(Some);
        }
        let limit = if self.given { Some(Limit::Method) } else { self.refine() };
        limit.map(|limit| self.plan(limit)).transpose()
    }

    /// What a piece costs at most that [`advance`](Self::advance) does for `cost`: as much, or one step that costs more.
    #[must_use]
    pub fn piece(&self, cost: f32) -> f32 {
        let step = self.pass.most_expensive_step(&self.costs);
        if cost > step { cost } else { step }
    }

    /// Takes the best of the candidates so far.
    fn keep_best(&mut self) {
        for candidate in self.pass.candidates() {
            if self.is_better(candidate) {
                self.best = Some(*candidate);
            }
        }
    }

    /// Whether something is right to the end.
    fn is_complete(&self) -> bool {
        self.best.is_some_and(|best| best.right >= self.problem.frames())
    }

    /// Goes on to finer steps, or to `f64` where rounding is what limits; what forbids it, if anything does.
    fn refine(&mut self) -> Option<Limit> {
        let by_rounding = self.pass.shadowed().by_rounding;
        let (single, steps) = match (&self.pass, by_rounding) {
            (Pass::Double(_), true) => return Some(Limit::Growth),
            (Pass::Double(_), false) => (false, self.steps.saturating_mul(2)),
            (Pass::Single(_), true) => (false, self.first),
            (Pass::Single(_), false) => (true, self.steps.saturating_mul(2)),
        };
        let cheapest = if single { Method::DirectionPlain } else { Method::Direction8 };
        if steps > MOST_STEPS || self.costs.of_frame(cheapest, steps) > self.budget.frame {
            return Some(Limit::Budget);
        }
        self.pass = if single {
            Pass::Single(Single::new(&self.problem, &self.start, steps))
        } else {
            Pass::Double(Double::new(&self.problem, &self.start, steps))
        };
        (self.steps, self.frame) = (steps, 0);
        None
    }

    /// Whether `candidate` goes so much farther than the best so far, or as far and cheaper.
    fn is_better(&self, candidate: &Candidate) -> bool {
        let cost = |candidate: &Candidate| self.costs.of_frame(candidate.method, candidate.steps);
        if candidate.right == 0 || cost(candidate) > self.budget.frame {
            return false;
        }
        self.best.is_none_or(|best| {
            let reaches_end = candidate.right >= self.problem.frames() && best.right < candidate.right;
            let farther = f64::from(candidate.right) > WORTH * f64::from(best.right);
            let cheaper = candidate.right >= best.right && cost(candidate) < cost(&best);
            reaches_end || farther || cheaper
        })
    }

    /// The best candidate as a plan, if there is one.
    fn plan(&self, limit: Limit) -> Result<Plan, PlanError> {
        let Some(best) = self.best else {
            // To look ahead for longer would help nothing of which a frame costs too much.
            let affordable = |one: &Candidate| self.costs.of_frame(one.method, one.steps) <= self.budget.frame;
            let open = self.pass.candidates().iter().any(|one| !one.failed && affordable(one));
            let limit = if limit == Limit::Planning && !open { Limit::Budget } else { limit };
            return Err(PlanError::NothingHolds { limit, spent: self.spent });
        };
        let steps = if best.method == Method::ClosedForm { 0 } else { best.steps };
        let rate = f64::from(self.problem.rate);
        Ok(Plan {
            method: best.method,
            steps,
            dt: if steps == 0 { 0.0 } else { 1.0 / (rate * f64::from(steps)) },
            error: best.error,
            cost: self.costs.of_frame(best.method, best.steps),
            horizon: if limit == Limit::End { self.problem.duration } else { self.problem.time(best.right) },
            limit,
            spent: self.spent,
        })
    }
}

/// The least power of two of steps to a frame that keeps [`FIRST_STEP`], where steps of `admissible` seconds are.
fn first_steps(problem: &Problem, admissible: f64) -> u32 {
    let longest = FIRST_STEP * admissible;
    let mut steps = 1;
    while steps < MOST_STEPS && longest * f64::from(problem.rate) * f64::from(steps) < 1.0 {
        steps *= 2;
    }
    steps
}
