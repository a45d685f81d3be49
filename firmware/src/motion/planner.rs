//! The plan of the scene played: the cheapest way to show its motion right to half a pixel, beside the way it is shown.
//!
//! Both are found by the kernel's [`plan`](double_pendulum::plan), in the time that frames leave free, piece by piece.
//! The scene does not wait for it and goes on as it is: the way and the steps of every scene are the same always, so that
//! its state after n ticks is.

use double_pendulum::Error;
use double_pendulum::plan::{Budget, Costs, Limit, Method, Plan, Problem, Search};

use crate::config::{COSTS, PLANNED, PLANNING_PIECE, PLANNING_TICKS, TICK_CYCLES, TICK_RATE};
use crate::motion::settings::Settings;
use crate::protocol::Planned;

/// How a scene shows its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The way it is computed.
    pub way: Method,
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
    /// What becomes of the way that the scene is shown in, and the plan beside it.
    Shown {
        /// The way it is shown in.
        shown: Plan,
        /// The plan.
        plan: Plan,
    },
    /// The kernel refuses to plan it.
    Refused(Error),
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
    plan: Option<Plan>,
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

/// Half of a tick for a frame; the other half is for drawing.
fn budget(tick: u32) -> Budget {
    Budget { frame: 0.5 * tick as f32, planning: PLANNING_TICKS * tick as f32 }
}

impl Planner {
    /// For a processor that has `tick` cycles in a tick.
    pub fn set_tick(&mut self, tick: u32) {
        (self.tick, self.budget) = (tick, budget(tick));
    }

    /// Begins anew for a scene that starts with `settings`; one that shows no motion has no plan.
    pub fn start(&mut self, settings: &Settings, shown: Option<Shown>) {
        (self.search, self.plan, self.shown) = (None, None, None);
        self.task = shown.map(|shown| (scene(settings, &shown), shown));
    }

    /// Does a piece of the search if it fits into `left` cycles, one quarter of a tick being kept: whether it did, and
    /// what is found.
    pub fn work(&mut self, left: u32) -> (bool, Option<Finding>) {
        let piece = self.search.as_ref().map_or(0.0, |search| search.piece(PLANNING_PIECE));
        let is_over = self.task.is_none() || self.shown.is_some();
        if is_over || left < self.tick / 4 || (left as f32) < 1.25 * piece {
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
    fn advance(&mut self) -> Result<Option<Finding>, Error> {
        let Some((scene, Shown { way, steps, .. })) = &self.task else { return Ok(None) };
        let Some(search) = &mut self.search else {
            self.search = Some(match self.plan {
                None => Search::new(scene, &self.costs, &self.budget)?,
                Some(_) => Search::of(*way, *steps, scene, &self.costs, &self.budget)?,
            });
            return Ok(None);
        };
        let Some(found) = search.advance(PLANNING_PIECE)? else { return Ok(None) };
        self.search = None;
        Ok(Some(match self.plan {
            None => {
                self.plan = Some(found);
                Finding::Plan(found)
            }
            Some(plan) => {
                self.shown = Some(found);
                Finding::Shown { shown: found, plan }
            }
        }))
    }

    /// What is known of the plan, as an answer.
    pub fn answer(&self, request: u16) -> Planned {
        let Some((scene, _)) = &self.task else { return Planned { request, ..Planned::default() } };
        let found = 1 + u8::from(self.plan.is_some()) + u8::from(self.shown.is_some());
        let mut answer = Planned {
            request,
            found,
            height: scene.height,
            duration: scene.duration,
            frame_budget: self.budget.frame,
            planning_budget: self.budget.planning,
            ..Planned::default()
        };
        if let Some(Plan { way, steps, step, error, cycles, horizon, limit, planning }) = self.plan {
            (answer.way, answer.steps, answer.step) = (way_code(way), steps, step);
            (answer.error, answer.cycles, answer.horizon) = (error, cycles, horizon);
            (answer.limit, answer.planning) = (limit_code(limit), planning);
        }
        if let Some(Plan { way, steps, error, cycles, horizon, limit, .. }) = self.shown {
            (answer.shown_way, answer.shown_steps, answer.shown_limit) = (way_code(way), steps, limit_code(limit));
            (answer.shown_error, answer.shown_cycles, answer.shown_horizon) = (error, cycles, horizon);
        }
        answer
    }
}

/// What the kernel is asked to plan.
pub fn scene(settings: &Settings, shown: &Shown) -> Problem {
    Problem {
        pendulum: settings.parameters.cast(),
        start: settings.motion().cast(),
        height: shown.height.into(),
        duration: PLANNED,
        rate: TICK_RATE as u16,
    }
}

/// The way's place in [`Method::ALL`]: its code on the wire.
pub fn way_code(way: Method) -> u8 {
    Method::ALL.iter().position(|&known| known == way).map_or(u8::MAX, |place| place as u8)
}

/// The limit's place in [`Limit::ALL`]: its code on the wire.
pub fn limit_code(limit: Limit) -> u8 {
    Limit::ALL.iter().position(|&known| known == limit).map_or(u8::MAX, |place| place as u8)
}
