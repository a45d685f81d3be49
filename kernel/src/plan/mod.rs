//! Compute only what is seen: the cheapest method that keeps both bobs within a tolerance of the exact motion, and until
//! when it does.
//!
//! How fast an error grows is a property of the very motion: of two starts with the same energy one may be regular and
//! the other chaotic, and no formula in the energy tells them apart. So a search plans. It runs the motion itself, in coarse
//! steps and in fine ones, and compares where the bobs would be:
//!
//! | error of | is measured by |
//! |---|---|
//! | any method in 32 bits, the closed form | the distance to a run in 64 bits, and the error of that |
//! | the same, if planning cannot pay for that | the distances to three runs in finer steps, the numbers given to each an ulp off |
//! | truncation in 64 bits | the distance to a second run in 64 bits in other steps |
//! | rounding in 64 bits | its size where it arises, times the growth of small distances since |
//!
//! No run is taken for exact: along the one direction in which errors grow, two runs that are equally wrong may agree by
//! chance. Growth is measured by motions in 32 bits that are kept close to the one in 64 bits.
//!
//! The coarsest step at which anything stays within the tolerance to the end decides; of all that does the cheapest is
//! taken. If nothing does (chaos), what does longest is; if no method within the budgets meets the
//! tolerance in any frame, [`PlanError::NoMethod`] says so. The search begins at a step that resolves all motions of the energy, by the proven
//! bound of [`Pendulum::admissible_step`](crate::Pendulum::admissible_step), by compensated `f32` or 32 bits of fixed point,
//! whichever costs less, and at half and a quarter of it. It goes over to 64 bits where rounding is the larger error or these
//! cost less, in the finest steps that both budgets can pay for. Planning takes no heap, and is done in pieces that a busy
//! caller can afford ([`Search`]).
//!
//! What a step costs is the caller's business: [`Costs`] is a price list in any unit.
//!
//! ```
//! use double_pendulum::plan::{Budget, Costs, Plan, PlanError, Problem};
//! use double_pendulum::{Method, Motion, Parameters};
//!
//! // Cycles of a processor without a floating-point unit, and a display with 32 pixels to a metre: half of one may be missed.
//! let costs =
//!     Costs { closed_form: 8.2e3, direction_plain: 13e3, direction: 14.8e3, fixed32: 668.0, fixed64: 21.5e3, preparation: 155e3 };
//! let budget = Budget { frame: 400e3, planning: 3e9 };
//! let pendulum = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 };
//! let small =
//!     Problem { pendulum, start: Motion::at_rest(0.05, 0.05), tolerance: 0.5 / 32.0, duration: 10.0, rate: 60 };
//! let plan = Plan::search(&small, &costs, &budget)?;
//! assert_eq!((plan.method, plan.horizon), (Method::Rk4Fixed32, 10.0));
//!
//! let mut run = plan.run(&small)?;
//! run.advance(60)?; // a second of frames
//! let [[_sin1, _cos1], [_sin2, _cos2]] = run.directions();
//!
//! let poor = Budget { frame: 500.0, ..budget };
//! assert!(matches!(Plan::search(&small, &costs, &poor), Err(PlanError::NoMethod { .. })));
//! # Ok::<(), PlanError>(())
//! ```

mod candidate;
mod cost;
mod error;
mod problem;
mod run;
mod search;
mod shadow;
mod trial;

use crate::error::Error;
use crate::table::Method;
pub use cost::{Budget, Costs, Stepping};
pub use error::{Limit, PlanError};
pub use problem::Problem;
pub use run::{Directions, PlannedRun};
pub use search::Search;

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
    /// What computing a frame costs, without drawing it; never more than the budget, but where the method was asked for.
    pub cost: f32,
    /// Until when every frame is predicted to be right to the tolerance, s: the time of the last of them. It is no proof: the bound
    /// on roundings is a measured one, and a frame may be wrong a little earlier (the repository's test `plan_study`).
    pub horizon: f64,
    /// What ends the horizon.
    pub limit: Limit,
    /// What planning has cost; never more than the budget.
    pub spent: f32,
}

impl Plan {
    /// The plan for `problem` at once: [`Search`] to its end.
    ///
    /// Refuses what [`Search::new`] and [`Search::advance`] refuse; [`PlanError::NoMethod`] if none meets the tolerance.
    pub fn search(problem: &Problem, costs: &Costs, budget: &Budget) -> Result<Self, PlanError> {
        let mut search = Search::new(problem, costs, budget)?;
        loop {
            if let Some(plan) = search.advance(f32::INFINITY)? {
                return Ok(plan);
            }
        }
    }

    #[doc(hidden)]
    #[must_use]
    pub fn stepping(&self) -> Stepping {
        Stepping {
            method: self.method,
            steps: self.steps.max(1),
        }
    }

    /// The motion of `problem`, for which the plan is, at its start.
    ///
    /// Refuses what [`PlannedRun::new`] refuses.
    pub fn run(&self, problem: &Problem) -> Result<PlannedRun, Error> {
        PlannedRun::new(problem, self.stepping())
    }
}
