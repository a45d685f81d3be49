//! The plan of the scene played: the cheapest method to show its motion right to half a pixel, beside the one it is shown by.
//!
//! Both are found by the kernel's [`plan`](double_pendulum::plan), in the time that frames leave free, piece by piece.
//! The scene does not wait for it and goes on as it is: the method and the steps of every scene are the same always, so
//! that its state after n ticks is.

use double_pendulum::Parameters;
use double_pendulum::plan::{Budget, Costs, Limit, Method, Plan, PlanError, Problem, Search};

use crate::config::{COSTS, FRAME_SHARE, HALF_PIXEL, PLANNED, PLANNING_PIECE, PLANNING_TICKS, TICK_CYCLES, TICK_RATE};
use crate::motion::settings::Settings;
use crate::protocol::{NO_METHOD, Planned, limit_code, method_code};

/// One part in so many of each tick is left to whatever comes up before its end.
const RESERVE: u32 = 4;
/// A piece must fit in with this margin, for what it costs is an estimate.
const PIECE_MARGIN: f32 = 1.25;

/// How a scene shows its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The method it is computed by.
    pub method: Method,
    /// Steps to a tick.
    pub steps: u32,
    /// The height of a display, pixels, that shows the motion as large: both rods together are half of it long.
    pub height: f32,
}

/// What has been found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finding {
    /// The plan.
    Plan(Plan),
    /// Nothing that this processor can afford is right in any frame; what forbids finer steps.
    NothingHolds(Limit),
    /// What becomes of the method that the scene is shown by, and the plan beside it if there is one.
    Shown {
        /// The method it is shown by.
        shown: Plan,
        /// The plan.
        plan: Option<Plan>,
    },
    /// The kernel refuses to plan it.
    Refused(PlanError),
}

/// Looks ahead for the scene that is played.
#[derive(Clone, Copy, Debug)]
pub struct Planner {
    costs: Costs,
    budget: Budget,
    /// Cycles of a tick.
    tick: u32,
    task: Option<(Problem, Shown)>,
    search: Option<Search>,
    /// The plan once it is found, or what forbids any.
    plan: Option<Result<Plan, Limit>>,
    shown: Option<Plan>,
}

impl Default for Planner {
    fn default() -> Self {
        Self {
            costs: COSTS,
            budget: budget(TICK_CYCLES),
            tick: TICK_CYCLES,
            task: None,
            search: None,
            plan: None,
            shown: None,
        }
    }
}

fn budget(tick: u32) -> Budget {
    Budget { frame: FRAME_SHARE * tick as f32, planning: PLANNING_TICKS * tick as f32 }
}

impl Planner {
    /// For a processor that has `tick` cycles in a tick.
    pub fn set_tick(&mut self, tick: u32) {
        (self.tick, self.budget) = (tick, budget(tick));
    }

    /// Begins anew for a scene that starts with `settings`; one that shows no motion has no plan.
    pub fn start(&mut self, settings: &Settings, shown: Option<Shown>) {
        (self.search, self.plan, self.shown) = (None, None, None);
        self.task = shown.map(|shown| (problem(settings, &shown), shown));
    }

    /// Does a piece of the search if it fits into `left` cycles and leaves the reserve: whether it did, and what is found.
    #[inline(never)]
    pub fn work(&mut self, left: u32) -> (bool, Option<Finding>) {
        let piece = self.search.as_ref().map_or(0.0, |search| search.piece(PLANNING_PIECE));
        let is_over = self.task.is_none() || self.shown.is_some();
        if is_over || left < self.tick / RESERVE || (left as f32) < PIECE_MARGIN * piece {
            return (false, None);
        }
        let finding = self.advance().unwrap_or_else(|error| {
            self.task = None;
            Some(Finding::Refused(error))
        });
        (true, finding)
    }

    /// Never inlined: a search stands on the stack while it is made.
    #[inline(never)]
    fn advance(&mut self) -> Result<Option<Finding>, PlanError> {
        let Some((problem, Shown { method, steps, .. })) = &self.task else { return Ok(None) };
        let Some(search) = &mut self.search else {
            self.search = Some(match self.plan {
                None => Search::new(problem, &self.costs, &self.budget)?,
                Some(_) => Search::of(*method, *steps, problem, &self.costs, &self.budget)?,
            });
            return Ok(None);
        };
        let found = match search.advance(PLANNING_PIECE) {
            Ok(None) => return Ok(None),
            Ok(Some(found)) => Ok(found),
            Err(PlanError::NothingHolds { limit, .. }) => Err(limit),
            Err(error) => return Err(error),
        };
        self.search = None;
        Ok(Some(match (self.plan, found) {
            (Some(plan), Ok(shown)) => {
                self.shown = Some(shown);
                Finding::Shown { shown, plan: plan.ok() }
            }
            (_, Ok(plan)) => {
                self.plan = Some(Ok(plan));
                Finding::Plan(plan)
            }
            (_, Err(limit)) => {
                self.plan = Some(Err(limit));
                Finding::NothingHolds(limit)
            }
        }))
    }

    /// What is known of the plan, as an answer.
    pub fn answer(&self, request: u16) -> Planned {
        let Some((problem, Shown { height, .. })) = &self.task else {
            return Planned { request, ..Planned::default() };
        };
        let found = 1 + u8::from(self.plan.is_some()) + u8::from(self.shown.is_some());
        let mut answer = Planned {
            request,
            found,
            height: (*height).into(),
            duration: problem.duration,
            frame_budget: self.budget.frame,
            planning_budget: self.budget.planning,
            ..Planned::default()
        };
        match self.plan {
            Some(Ok(Plan { method, steps, dt, error, cost, horizon, limit, spent })) => {
                (answer.method, answer.steps, answer.dt) = (method_code(method), steps, dt);
                (answer.error, answer.cycles, answer.horizon) = (HALF_PIXEL * error, cost, horizon);
                (answer.limit, answer.planning) = (limit_code(limit), spent);
            }
            Some(Err(limit)) => (answer.method, answer.limit) = (NO_METHOD, limit_code(limit)),
            None => {}
        }
        if let Some(Plan { method, steps, error, cost, horizon, limit, .. }) = self.shown {
            (answer.shown_method, answer.shown_steps) = (method_code(method), steps);
            (answer.shown_error, answer.shown_cycles) = (HALF_PIXEL * error, cost);
            (answer.shown_horizon, answer.shown_limit) = (horizon, limit_code(limit));
        }
        answer
    }
}

/// What the kernel is asked to plan.
pub fn problem(settings: &Settings, shown: &Shown) -> Problem {
    let pendulum = settings.parameters.cast();
    Problem {
        pendulum,
        start: settings.motion().cast(),
        tolerance: half_pixel(&pendulum, shown.height.into()),
        duration: PLANNED,
        rate: TICK_RATE as u16,
    }
}

/// [`HALF_PIXEL`] in metres on a display `height` pixels high: both rods together are half of it long.
pub fn half_pixel(&Parameters { l1, l2, .. }: &Parameters<f64>, height: f64) -> f64 {
    f64::from(HALF_PIXEL) * (l1 + l2) / (0.5 * height)
}
