//! From coarse steps to fine ones until something is right to the end.
//!
//! All of it is done in pieces that a busy caller can afford: a few steps of one motion, a comparison, a new step size.

use super::cost::{Budget, Costs, Method};
use super::pass::{Candidate, Double, Pass, Single};
use super::problem::{HALF_PIXEL, Problem};
use crate::error::Error;
use crate::hamiltonian::Pendulum;
use crate::state::State;

/// The cheapest way found, and what it brings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    /// The way to compute the scene.
    pub way: Method,
    /// Steps to a frame; 0 for the closed form.
    pub steps: u32,
    /// The step size, s; 0 for the closed form.
    pub step: f64,
    /// The largest error expected until the horizon, pixels.
    pub error: f32,
    /// Cycles to compute a frame, without drawing it.
    pub cycles: f32,
    /// Until when every frame is right to half a pixel, s.
    pub horizon: f64,
    /// What ends the horizon.
    pub limit: Limit,
    /// Cycles spent on looking ahead.
    pub planning: f32,
}

/// What ends a horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Limit {
    /// The scene itself: all of it is right.
    End,
    /// The growth of errors: nothing finer goes farther.
    Growth,
    /// The budget for a frame: finer steps or `f64` may go farther, and cost more.
    Budget,
    /// The budget for looking ahead: nobody has looked farther.
    Planning,
    /// The way and the step that were asked for: others may go farther ([`Search::of`]).
    Method,
}

impl Limit {
    /// Every limit.
    pub const ALL: [Limit; 5] = [Limit::End, Limit::Growth, Limit::Budget, Limit::Planning, Limit::Method];

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Limit::End => "the scene's end",
            Limit::Growth => "the growth of errors",
            Limit::Budget => "the budget for a frame",
            Limit::Planning => "the budget for looking ahead",
            Limit::Method => "what this way can do",
        }
    }
}

/// A costlier way must be right for this much longer to be worth it.
const WORTH: f64 = 1.1;

/// The first step is no longer than this many admissible ones: the fastest rate that the scene's energy allows turns a
/// radian in it. In longer steps two runs could miss alike what neither sees.
const FIRST_STEP: f64 = 4.0;

/// Finer steps than this many to a frame are never tried.
const MOST_STEPS: u32 = 1 << 16;

/// A search under way; [`advance`](Self::advance) it until there is a plan.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    problem: Problem,
    costs: Costs,
    budget: Budget,
    /// Angles and momenta at the start.
    start: State<f64>,
    /// The coarsest steps to a frame.
    first: u32,
    look: Pass,
    steps: u32,
    /// Frames looked at with these steps.
    frame: u32,
    /// Whether the next frame is within the budget, and is being computed.
    begun: bool,
    /// Whether the way and the step are given.
    given: bool,
    spent: f32,
    best: Option<Candidate>,
}

impl Search {
    /// For the cheapest way.
    ///
    /// Refuses a scene that cannot be shown or whose pendulum the kernel refuses, and a budget that is not positive.
    pub fn new(problem: &Problem, costs: &Costs, budget: &Budget) -> Result<Self, Error> {
        problem.check()?;
        costs.check()?;
        budget.check()?;
        let pendulum = Pendulum::new(problem.pendulum)?;
        let start = pendulum.to_state(&problem.start);
        let first = first_steps(problem, pendulum.admissible_step(&start)?);
        Ok(Self {
            problem: *problem,
            costs: *costs,
            budget: *budget,
            start,
            first,
            look: Pass::Single(Single::new(problem, &start, first)),
            steps: first,
            frame: 0,
            begun: false,
            given: false,
            spent: 0.0,
            best: None,
        })
    }

    /// For no way but this one, with `steps` steps to a frame: how long it is right, whatever it costs. The closed form
    /// has no steps; those given are the ones it is shadowed with.
    ///
    /// Refuses what [`new`](Self::new) refuses. No steps count as one.
    pub fn of(way: Method, steps: u32, problem: &Problem, costs: &Costs, budget: &Budget) -> Result<Self, Error> {
        let search = Self::new(problem, costs, budget)?;
        let steps = if steps > 0 { steps } else { 1 };
        let mut look = match way {
            Method::Direction8 => Pass::Double(Double::new(problem, &search.start, steps)),
            _ => Pass::Single(Single::new(problem, &search.start, steps)),
        };
        look.only(way);
        let budget = Budget { frame: f32::INFINITY, ..*budget };
        Ok(Self { look, steps, budget, given: true, best: Some(Candidate::new(way, steps)), ..search })
    }

    /// Does a piece of the search: steps of one motion for as many `cycles`, by the costs given, or one that costs more;
    /// or the preparation of a motion; or a comparison. The plan, when it is found.
    ///
    /// Refuses what a [`Form`](crate::form::Form) refuses: a pendulum out of the range of `f32`.
    pub fn advance(&mut self, cycles: f32) -> Result<Option<Plan>, Error> {
        if !self.begun {
            let cost = self.look.cost(&self.costs);
            if self.spent + cost > self.budget.planning {
                self.keep_best();
                return Ok(Some(self.plan(Limit::Planning)));
            }
            self.spent += cost;
            self.begun = true;
        }
        if self.look.advance(&self.costs, cycles)? {
            return Ok(None);
        }
        self.begun = false;
        self.frame += 1;
        self.look.compare(self.problem.time(self.frame), HALF_PIXEL);
        let at_end = self.frame >= self.problem.frames();
        if !at_end && self.look.candidates().iter().any(|candidate| !candidate.failed) {
            return Ok(None);
        }
        self.keep_best();
        if self.is_complete() {
            return Ok(Some(self.plan(Limit::End)));
        }
        let limit = if self.given { Some(Limit::Method) } else { self.refine() };
        Ok(limit.map(|limit| self.plan(limit)))
    }

    /// Cycles of the most expensive steps that [`advance`](Self::advance) makes with so many `cycles`.
    pub fn piece(&self, cycles: f32) -> f32 {
        let step = self.look.dearest_step(&self.costs);
        if cycles > step { cycles } else { step }
    }

    /// Takes the best of the candidates so far.
    fn keep_best(&mut self) {
        for candidate in self.look.candidates() {
            if self.is_better(candidate) {
                self.best = Some(*candidate);
            }
        }
    }

    /// Whether something is right to the end of the scene.
    fn is_complete(&self) -> bool {
        self.best.is_some_and(|best| best.right >= self.problem.frames())
    }

    /// Goes on to finer steps, or to `f64` where rounding is what limits; what forbids it, if anything does.
    fn refine(&mut self) -> Option<Limit> {
        let by_rounding = self.look.judge().by_rounding;
        let (single, steps) = match (&self.look, by_rounding) {
            (Pass::Double(_), true) => return Some(Limit::Growth),
            (Pass::Double(_), false) => (false, self.steps.saturating_mul(2)),
            (Pass::Single(_), true) => (false, self.first),
            (Pass::Single(_), false) => (true, self.steps.saturating_mul(2)),
        };
        let way = if single { Method::DirectionPlain } else { Method::Direction8 };
        if steps > MOST_STEPS || self.costs.of_frame(way, steps) > self.budget.frame {
            return Some(Limit::Budget);
        }
        self.look = if single {
            Pass::Single(Single::new(&self.problem, &self.start, steps))
        } else {
            Pass::Double(Double::new(&self.problem, &self.start, steps))
        };
        (self.steps, self.frame) = (steps, 0);
        None
    }

    /// Whether `candidate` goes so much farther than the best so far, or as far and cheaper.
    fn is_better(&self, candidate: &Candidate) -> bool {
        let cost = |candidate: &Candidate| self.costs.of_frame(candidate.way, candidate.steps);
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

    /// The best candidate as a plan; if nothing affordable was right in any frame, what judges, for no time at all.
    fn plan(&self, limit: Limit) -> Plan {
        let best = self.best.unwrap_or(Candidate { right: 0, error: 0.0, ..*self.look.judge() });
        let steps = if best.way == Method::ClosedForm { 0 } else { best.steps };
        let rate = f64::from(self.problem.rate);
        Plan {
            way: best.way,
            steps,
            step: if steps == 0 { 0.0 } else { 1.0 / (rate * f64::from(steps)) },
            error: best.error,
            cycles: self.costs.of_frame(best.way, best.steps),
            horizon: if limit == Limit::End { self.problem.duration } else { self.problem.time(best.right) },
            limit,
            planning: self.spent,
        }
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
