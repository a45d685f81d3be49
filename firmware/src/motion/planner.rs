//! Plans the scene that is played: which method and steps are right to half a pixel for longest, and cheapest, and until when.
//!
//! All by the kernel's [`plan`](double_pendulum::plan), for a number of cycles in each tick of the scene that is the same on
//! all boards of a class: so what has been found after n ticks is, too. The work itself may be done before the tick, in the
//! time that a frame leaves free.

use double_pendulum::plan::{Budget, Limit, Plan, PlanError, Search, Stepping};

use crate::config::{PLANNED, PLANNING_PIECE, Processor, SETTLED_TICKS, TICK_RATE};
use crate::motion::Settings;

/// The plan, or why there is none. One that was right to its end is looked at farther, and told again when that comes to an end.
pub type PlanResult = Result<Plan, PlanError>;

/// A plan, and what it is made for.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Planned {
    /// `None` while the search is under way.
    pub found: Option<PlanResult>,
    /// The display's height, pixels: both rods together are half of it long.
    pub height: f32,
    /// For how long, s.
    pub duration: f64,
    /// What computing a frame may cost, cycles.
    pub frame: f32,
    /// What planning may cost, cycles.
    pub planning: f32,
}

#[derive(Clone, Copy, Debug)]
pub struct Planner {
    pub processor: Processor,
    /// Of the scene since its start.
    pub ticks: u64,
    /// The settings, and the height of a display, pixels, that shows them as large: both rods together are half of it long.
    pub task: Option<(Settings, f32)>,
    search: Option<Search>,
    /// Cycles of the ticks to come that have been spent.
    debt: f32,
    plan: Option<PlanResult>,
    /// What the scene has begun by, and until when that is expected to be right, s.
    begun: Option<(Stepping, f64)>,
    /// The scene keeps this stepping, whatever is planned.
    is_tied: bool,
    /// Something has been found that no tick has told yet.
    is_news: bool,
    /// The next tick tells it, and does nothing else.
    is_due: bool,
}

impl Planner {
    pub fn new(processor: Processor) -> Self {
        let (task, search, plan, begun) = (None, None, None, None);
        let (is_tied, is_news, is_due) = (false, false, false);
        Self {
            processor,
            ticks: 0,
            task,
            search,
            debt: 0.0,
            plan,
            begun,
            is_tied,
            is_news,
            is_due,
        }
    }

    /// Begins anew for a scene that starts with `settings`, by `begun`, to which it may be tied; one without a height shows no
    /// motion, and has no plan.
    pub fn start(
        &mut self,
        settings: &Settings,
        height: Option<f32>,
        begun: Option<Stepping>,
        is_tied: bool,
    ) {
        self.task = height.map(|height| (*settings, height));
        (self.search, self.plan, self.begun, self.is_tied) =
            (None, None, begun.map(|stepping| (stepping, 0.0)), is_tied);
        (self.ticks, self.debt, self.is_news, self.is_due) = (0, 0.0, false, false);
    }

    /// Does all that this tick of the scene may spend, but what has been done before. What is found the next one tells, and does
    /// nothing else: to follow it takes time, too.
    pub fn tick(&mut self) -> Option<PlanResult> {
        self.ticks += 1;
        if core::mem::take(&mut self.is_due) {
            self.is_news = false;
            return self.plan;
        }
        if self.ticks > SETTLED_TICKS {
            while self.work() {}
            self.debt = (self.debt - self.processor.look_ahead).max(0.0);
        }
        self.note();
        self.is_due = self.is_news;
        None
    }

    /// Takes note of how far what the scene has begun by has been looked at.
    #[inline(never)] // one copy
    fn note(&mut self) {
        self.begun = self
            .begun
            .map(|(stepping, horizon)| (stepping, horizon.max(self.looked_at(stepping))));
    }

    /// Lets a tick of the scene pass that has no time for this.
    pub fn rest(&mut self) {
        self.ticks += 1;
    }

    /// Does a piece of what the next tick may spend; whether there is more.
    pub fn work_ahead(&mut self) -> bool {
        self.ticks >= SETTLED_TICKS && self.work()
    }

    /// Until when the frames are expected to be right of a scene that goes by this `stepping`, s.
    pub fn horizon(&self, stepping: Stepping) -> f64 {
        let begun = self
            .begun
            .filter(|(begun, _)| *begun == stepping)
            .map(|(_, horizon)| horizon);
        let plan = self
            .plan
            .and_then(Result::ok)
            .filter(|plan| plan.stepping() == stepping);
        begun
            .unwrap_or_else(|| self.looked_at(stepping))
            .max(plan.map_or(0.0, |plan| plan.horizon))
    }

    /// Until when the search has found it right so far.
    #[inline(never)] // one copy
    fn looked_at(&self, stepping: Stepping) -> f64 {
        self.search
            .as_ref()
            .map_or(0.0, |search| search.horizon(stepping))
    }

    /// Whether it may turn out that they are for longer.
    pub fn is_looking(&self) -> bool {
        self.task.is_some() && (self.plan.is_none() || self.search.is_some())
    }

    /// Does a piece of the search, if the tick has time for it; whether it has done one. A preparation that a tick has no time
    /// for waits for one that has nothing else to do.
    #[inline(never)] // a profile of a frame tells planning by it
    fn work(&mut self) -> bool {
        if self.is_news || !self.is_looking() || self.is_far() {
            return false;
        }
        let is_preparing = self.search.as_ref().is_none_or(Search::is_preparing);
        let long = if is_preparing {
            self.processor.costs.preparation
        } else {
            0.0
        };
        if self.debt > 0.0 && self.debt + long >= self.processor.look_ahead {
            return false;
        }
        let before = self.search.as_ref().map_or(0.0, Search::spent);
        let found = self.advance().transpose();
        let spent = self.search.as_ref().map_or(0.0, Search::spent) - before;
        let least = if before == 0.0 {
            long
        } else {
            self.processor.piece()
        };
        self.debt += spent.max(least);
        if let Some(found) = found {
            self.take(found);
        }
        true
    }

    /// Whether a plan that was right to its end has been looked at far enough for now.
    fn is_far(&self) -> bool {
        self.plan.and_then(Result::ok).is_some_and(|plan| {
            let far = self.ticks as f64 / f64::from(TICK_RATE) + PLANNED;
            self.looked_at(plan.stepping()) >= far
        })
    }

    #[inline(never)] // a search stands on the stack while it is made
    fn advance(&mut self) -> Result<Option<Plan>, PlanError> {
        let Some((settings, height)) = self.task else {
            return Ok(None);
        };
        let Some(search) = &mut self.search else {
            let problem = settings.problem(height);
            let (costs, budget) = (&self.processor.costs, self.processor.budget(&problem));
            self.search = Some(match self.begun {
                Some((stepping, _)) if self.is_tied => {
                    Search::of(stepping, &problem, costs, &budget)?
                }
                _ => Search::new(&problem, costs, &budget)?,
            });
            return Ok(None);
        };
        search.advance(PLANNING_PIECE)
    }

    /// What is right to the end is looked at farther; all else ends the search.
    fn take(&mut self, found: PlanResult) {
        (self.plan, self.is_news) = (Some(found), true);
        match (&mut self.search, found) {
            (
                Some(search),
                Ok(Plan {
                    limit: Limit::End, ..
                }),
            ) => search.extend(FOR_EVER),
            _ => {
                self.note();
                self.search = None;
            }
        }
    }

    pub fn answer(&self) -> Option<Planned> {
        let (settings, height) = self.task?;
        let problem = settings.problem(height);
        let Budget { frame, planning } = self.processor.budget(&problem);
        Some(Planned {
            found: self.plan,
            height,
            duration: problem.duration,
            frame,
            planning,
        })
    }
}

/// Longer than anything is played, s: four months.
const FOR_EVER: f64 = 1e7;
