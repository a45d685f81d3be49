//! From coarse steps to fine ones until something is right to the end.
//!
//! All of it is done in pieces that a busy caller can afford: a few steps of one motion, a comparison, a new step size.

use super::cost::{Budget, Costs, Way};
use super::look::{Double, Look, Single, Trial};
use super::scene::{HALF_PIXEL, Scene};
use crate::error::Error;
use crate::hamiltonian::Pendulum;
use crate::state::State;

/// The cheapest way found, and what it brings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plan {
    /// The way to compute the scene.
    pub way: Way,
    /// Steps to a picture; 0 for the closed form.
    pub steps: u32,
    /// The step size, s; 0 for the closed form.
    pub step: f64,
    /// The largest error expected until the horizon, pixels.
    pub error: f32,
    /// Cycles to compute a picture, without drawing it.
    pub cycles: f32,
    /// Until when every picture is right to half a pixel, s.
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
    Scene,
    /// The growth of errors: nothing finer goes farther.
    Growth,
    /// The budget for a picture: finer steps or `f64` may go farther, and cost more.
    Budget,
    /// The budget for looking ahead: nobody has looked farther.
    Planning,
    /// The way and the step that were asked for: others may go farther ([`Search::of`]).
    Way,
}

impl Limit {
    /// Every limit.
    pub const ALL: [Limit; 5] = [Limit::Scene, Limit::Growth, Limit::Budget, Limit::Planning, Limit::Way];

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Limit::Scene => "the scene's end",
            Limit::Growth => "the growth of errors",
            Limit::Budget => "the budget for a picture",
            Limit::Planning => "the budget for looking ahead",
            Limit::Way => "what this way can do",
        }
    }
}

/// A dearer way must be right for this much longer to be worth it.
const WORTH: f64 = 1.1;

/// The first step is no longer than this many admissible ones: the fastest rate that the scene's energy allows turns a
/// radian in it. In longer steps two runs could miss alike what neither sees.
const FIRST_STEP: f64 = 4.0;

/// Finer steps than this many to a picture are never tried.
const MOST_STEPS: u32 = 1 << 16;

/// A search under way; [`advance`](Self::advance) it until there is a plan.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    scene: Scene,
    costs: Costs,
    budget: Budget,
    /// Angles and momenta at the start.
    start: State<f64>,
    /// The coarsest steps to a picture.
    first: u32,
    look: Look,
    steps: u32,
    /// Pictures looked at with these steps.
    frame: u32,
    /// Whether the next picture is within the budget, and is being computed.
    begun: bool,
    /// Whether the way and the step are given.
    given: bool,
    spent: f32,
    best: Option<Trial>,
}

impl Search {
    /// For the cheapest way.
    ///
    /// Refuses a scene that cannot be shown or whose pendulum the kernel refuses, and a budget that is not positive.
    pub fn new(scene: &Scene, costs: &Costs, budget: &Budget) -> Result<Self, Error> {
        scene.check()?;
        costs.check()?;
        budget.check()?;
        let pendulum = Pendulum::new(scene.pendulum)?;
        let start = pendulum.state(&scene.start);
        let first = first_steps(scene, pendulum.admissible_step(&start)?);
        Ok(Self {
            scene: *scene,
            costs: *costs,
            budget: *budget,
            start,
            first,
            look: Look::Single(Single::new(scene, &start, first)),
            steps: first,
            frame: 0,
            begun: false,
            given: false,
            spent: 0.0,
            best: None,
        })
    }

    /// For no way but this one, with `steps` steps to a picture: how long it is right, whatever it costs. The closed form
    /// has no steps; those given are the ones it is judged with.
    ///
    /// Refuses what [`new`](Self::new) refuses. No steps count as one.
    pub fn of(way: Way, steps: u32, scene: &Scene, costs: &Costs, budget: &Budget) -> Result<Self, Error> {
        let search = Self::new(scene, costs, budget)?;
        let steps = if steps > 0 { steps } else { 1 };
        let mut look = match way {
            Way::Picture8 => Look::Double(Double::new(scene, &search.start, steps)),
            _ => Look::Single(Single::new(scene, &search.start, steps)),
        };
        look.only(way);
        let budget = Budget { frame: f32::INFINITY, ..*budget };
        Ok(Self { look, steps, budget, given: true, best: Some(Trial::new(way, steps)), ..search })
    }

    /// Does a piece of the search: steps of one motion for as many `cycles`, by the costs given, or one that costs more;
    /// or the preparation of a motion; or a comparison. The plan, when it is found.
    ///
    /// Refuses what a [`Form`](crate::form::Form) refuses: a pendulum out of the range of `f32`.
    pub fn advance(&mut self, cycles: f32) -> Result<Option<Plan>, Error> {
        if !self.begun {
            let cost = self.look.cost(&self.costs);
            if self.spent + cost > self.budget.planning {
                self.settle();
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
        self.look.compare(self.scene.time(self.frame), HALF_PIXEL);
        let at_end = self.frame >= self.scene.frames();
        if !at_end && self.look.trials().iter().any(|trial| !trial.failed) {
            return Ok(None);
        }
        self.settle();
        if self.is_complete() {
            return Ok(Some(self.plan(Limit::Scene)));
        }
        let limit = if self.given { Some(Limit::Way) } else { self.refine() };
        Ok(limit.map(|limit| self.plan(limit)))
    }

    /// Cycles of the dearest steps that [`advance`](Self::advance) makes with so many `cycles`.
    pub fn piece(&self, cycles: f32) -> f32 {
        let step = self.look.dearest_step(&self.costs);
        if cycles > step { cycles } else { step }
    }

    /// Takes the best of the trials so far.
    fn settle(&mut self) {
        for trial in self.look.trials() {
            if self.is_better(trial) {
                self.best = Some(*trial);
            }
        }
    }

    /// Whether something is right to the end of the scene.
    fn is_complete(&self) -> bool {
        self.best.is_some_and(|best| best.right >= self.scene.frames())
    }

    /// Goes on to finer steps, or to `f64` where rounding is what limits; what forbids it, if anything does.
    fn refine(&mut self) -> Option<Limit> {
        let by_rounding = self.look.judge().by_rounding;
        let (single, steps) = match (&self.look, by_rounding) {
            (Look::Double(_), true) => return Some(Limit::Growth),
            (Look::Double(_), false) => (false, self.steps.saturating_mul(2)),
            (Look::Single(_), true) => (false, self.first),
            (Look::Single(_), false) => (true, self.steps.saturating_mul(2)),
        };
        let way = if single { Way::PicturePlain } else { Way::Picture8 };
        if steps > MOST_STEPS || self.costs.of_frame(way, steps) > self.budget.frame {
            return Some(Limit::Budget);
        }
        self.look = if single {
            Look::Single(Single::new(&self.scene, &self.start, steps))
        } else {
            Look::Double(Double::new(&self.scene, &self.start, steps))
        };
        (self.steps, self.frame) = (steps, 0);
        None
    }

    /// Whether `trial` goes so much farther than the best so far, or as far and cheaper.
    fn is_better(&self, trial: &Trial) -> bool {
        let cost = |trial: &Trial| self.costs.of_frame(trial.way, trial.steps);
        if trial.right == 0 || cost(trial) > self.budget.frame {
            return false;
        }
        self.best.is_none_or(|best| {
            let reaches_end = trial.right >= self.scene.frames() && best.right < trial.right;
            let farther = f64::from(trial.right) > WORTH * f64::from(best.right);
            let cheaper = trial.right >= best.right && cost(trial) < cost(&best);
            reaches_end || farther || cheaper
        })
    }

    /// The best trial as a plan; if nothing affordable was right in any picture, what judges, for no time at all.
    fn plan(&self, limit: Limit) -> Plan {
        let best = self.best.unwrap_or(Trial { right: 0, error: 0.0, ..*self.look.judge() });
        let steps = if best.way == Way::ClosedForm { 0 } else { best.steps };
        let rate = f64::from(self.scene.rate);
        Plan {
            way: best.way,
            steps,
            step: if steps == 0 { 0.0 } else { 1.0 / (rate * f64::from(steps)) },
            error: best.error,
            cycles: self.costs.of_frame(best.way, best.steps),
            horizon: if limit == Limit::Scene { self.scene.duration } else { self.scene.time(best.right) },
            limit,
            planning: self.spent,
        }
    }
}

/// The least power of two of steps to a picture that keeps [`FIRST_STEP`], where steps of `admissible` seconds are.
fn first_steps(scene: &Scene, admissible: f64) -> u32 {
    let longest = FIRST_STEP * admissible;
    let mut steps = 1;
    while steps < MOST_STEPS && longest * f64::from(scene.rate) * f64::from(steps) < 1.0 {
        steps *= 2;
    }
    steps
}
