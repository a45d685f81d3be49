//! From coarse steps to fine ones until something is right to the end.

use super::cost::{Budget, Costs, Way};
use super::look::{Double, Look, Single, Trial};
use super::scene::{HALF_PIXEL, Scene};
use crate::error::Error;
use crate::hamiltonian::Pendulum;

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
pub enum Limit {
    /// The scene itself: all of it is right.
    Scene,
    /// The growth of errors: nothing finer goes farther.
    Growth,
    /// The budget for a picture: finer steps or `f64` may go farther, and cost more.
    Budget,
    /// The budget for looking ahead: nobody has looked farther.
    Planning,
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
    look: Look,
    steps: u32,
    /// Pictures looked at with these steps.
    frame: u32,
    spent: f32,
    best: Option<Trial>,
}

impl Search {
    /// Refuses a scene that cannot be shown or whose pendulum the kernel refuses, and a budget that is not positive.
    pub fn new(scene: &Scene, costs: &Costs, budget: &Budget) -> Result<Self, Error> {
        scene.check()?;
        costs.check()?;
        budget.check()?;
        let steps = first_steps(scene)?;
        let look = Look::Single(Single::new(scene, steps)?);
        Ok(Self { scene: *scene, costs: *costs, budget: *budget, look, steps, frame: 0, spent: 0.0, best: None })
    }

    /// Looks one picture further; the plan, when it is found.
    pub fn advance(&mut self) -> Result<Option<Plan>, Error> {
        let cost = self.look.cost(&self.costs);
        let exhausted = self.spent + cost > self.budget.planning;
        if !exhausted {
            self.spent += cost;
            self.frame += 1;
            self.look.advance(self.scene.time(self.frame), HALF_PIXEL);
            let at_end = self.frame >= self.scene.frames();
            if !at_end && self.look.trials().iter().any(|trial| !trial.failed) {
                return Ok(None);
            }
        }
        for trial in self.look.trials() {
            if self.is_better(trial) {
                self.best = Some(*trial);
            }
        }
        let limit = if self.best.is_some_and(|best| best.right >= self.scene.frames()) {
            Limit::Scene
        } else if exhausted {
            Limit::Planning
        } else {
            match self.refine()? {
                None => return Ok(None),
                Some(limit) => limit,
            }
        };
        Ok(Some(self.plan(limit)))
    }

    /// Goes on to finer steps, or to `f64` where rounding is what limits; what forbids it, if anything does.
    fn refine(&mut self) -> Result<Option<Limit>, Error> {
        let by_rounding = self.look.judge().by_rounding;
        let (single, steps) = match (&self.look, by_rounding) {
            (Look::Double(_), true) => return Ok(Some(Limit::Growth)),
            (Look::Double(_), false) => (false, self.steps.saturating_mul(2)),
            (Look::Single(_), true) => (false, first_steps(&self.scene)?),
            (Look::Single(_), false) => (true, self.steps.saturating_mul(2)),
        };
        let way = if single { Way::PicturePlain } else { Way::Picture8 };
        if steps > MOST_STEPS || self.costs.of_frame(way, steps) > self.budget.frame {
            return Ok(Some(Limit::Budget));
        }
        self.look = if single {
            Look::Single(Single::new(&self.scene, steps)?)
        } else {
            Look::Double(Double::new(&self.scene, steps)?)
        };
        (self.steps, self.frame) = (steps, 0);
        Ok(None)
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

/// The least power of two of steps to a picture that keeps [`FIRST_STEP`].
fn first_steps(scene: &Scene) -> Result<u32, Error> {
    let pendulum = Pendulum::new(scene.pendulum)?;
    let longest = FIRST_STEP * pendulum.admissible_step(&pendulum.state(&scene.start))?;
    let mut steps = 1;
    while steps < MOST_STEPS && longest * f64::from(scene.rate) * f64::from(steps) < 1.0 {
        steps *= 2;
    }
    Ok(steps)
}
