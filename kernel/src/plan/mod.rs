//! Planning: finds the cheapest method whose frames are accurate, and predicts its accuracy
//! horizon.
//!
//! A frame is accurate if both bobs, and bob 2 relative to bob 1, are within a tolerance of the exact
//! motion.
//!
//! # The race
//!
//! The methods run side by side, ahead of the scene, with a *reference* R in 64 bits. *Candidates*
//! are the closed form; RK4 in 32 bits in steps that resolve the motion, and in twice as many steps,
//! and so on; and the method in 64 bits that the scene starts with. In each frame
//!
//! ```text
//! bound(candidate) = distance(candidate, R) + error(R)              in units of the tolerance
//! ```
//!
//! A candidate leaves the race when its bound exceeds 1. The race ends with the problem, with the
//! last candidate, with R or with the planning budget. The plan is the cheapest candidate that
//! reached the end. If none did, it is the cheapest one whose horizon is at most a tenth shorter
//! than the longest.
//!
//! # The error of the reference
//!
//! A step of R extrapolates five rows. Without its first row, and without its first two, it would
//! be off by d8 and d6, which cost a few additions. From them follows the bound
//!
//! ```text
//! T = d8 max(1, x)        x = 32 |d8|/|d6|
//! ```
//!
//! The errors of R are in an ellipsoid of phase space with the matrix P. The motion maps small errors
//! by its derivative J, and n steps add truncation, T, and rounding, q, here diagonal matrices:
//!
//! ```text
//! P  <-  (1 + 1/b) J P J^T + (1 + b) T^2 + n q^2        b = sqrt(tr(J P J^T)/tr(T^2))
//! ```
//!
//! T adds up, because truncation may always point in the same direction. Rounding errors are
//! independent, and their squares add up. q follows from the number formats. J is measured by five
//! *shadows*, cheap motions in 32 bits that start close to R: one for each dimension, and one to
//! compare them with. The error of R in a frame is that of P on the display.
//!
//! # Budgets
//!
//! The budget of a frame limits the candidates. The planning budget pays for the shadows, for the
//! candidates, and for R. If it pays for no R, there is no promise: [`PlanError::NoMethod`]. R makes
//! steps so short that rounding is its larger error, or as many as planning can pay for. If
//! truncation of R has ended the race, it is repeated with finer steps. Planning is divided into
//! pieces that a busy caller can afford ([`Search`]).
//!
//! | file | idea |
//! |---|---|
//! | `problem`, `cost`, `prices` | the inputs |
//! | `steps` | the steps that resolve a motion |
//! | `run` | a motion that is advanced from frame to frame |
//! | `candidate` | a method, and for how long it is accurate |
//! | `reference` | T |
//! | `uncertainty` | P |
//! | `race` | the participants side by side |
//! | `entry` | the participants that the budgets pay for |
//! | `search` | the course of the races, and the plan |
//!
//! # Example
//!
//! ```
//! use double_pendulum::plan::{Budget, Costs, Plan, PlanError, Problem};
//! use double_pendulum::{Method, Motion, Parameters};
//!
//! // The costs are cycles of a processor without a floating-point unit.
//! let costs = Costs::CORTEX_M3;
//! let budget = Budget { frame: 400e3, planning: 3e9 };
//!
//! // The display has 32 pixels per metre. The tolerance is half a pixel.
//! let small = Problem {
//!     pendulum: Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 },
//!     start: Motion::at_rest(0.05, 0.05),
//!     tolerance: 0.5 / 32.0,
//!     duration: 10.0,
//!     rate: 60,
//! };
//! let plan = Plan::search(&small, &costs, &budget)?;
//! assert_eq!((plan.method, plan.horizon), (Method::Rk4Fixed32, 10.0));
//!
//! // Advance by the frames of one second.
//! let mut run = plan.run(&small)?;
//! run.advance(60)?;
//! let [[_sin1, _cos1], [_sin2, _cos2]] = run.directions();
//!
//! // This frame budget pays for no step.
//! let poor = Budget { frame: 500.0, ..budget };
//! assert!(matches!(Plan::search(&small, &costs, &poor), Err(PlanError::NoMethod { .. })));
//! # Ok::<(), PlanError>(())
//! ```

mod candidate;
mod cost;
mod entry;
mod error;
mod prices;
mod problem;
mod race;
mod reference;
mod run;
mod search;
mod steps;
mod uncertainty;

use crate::error::Error;
use crate::table::Method;
pub use cost::{Budget, Costs};
pub use error::{Limit, PlanError};
pub use problem::Problem;
pub use run::PlannedRun;
pub use search::Search;
pub use steps::Stepping;

/// The result of a search: the chosen method and its accuracy horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Plan {
    /// The method that computes the motion.
    pub method: Method,
    /// The number of steps per frame; 0 for the closed form.
    pub steps: u32,
    /// The step size, s; 0 for the closed form.
    pub dt: f64,
    /// The largest expected error until the horizon, divided by the tolerance: from 0 to 1, and 0
    /// if the horizon is 0.
    pub error: f32,
    /// The cost of computing a frame by the price list ([`Costs::of_frame`]), without drawing it.
    /// The search only chooses methods within the frame budget; a method that the caller has fixed
    /// ([`Search::of`]) may cost more.
    pub cost: f32,
    /// The accuracy horizon, s since the start: all frames up to this time, included, are predicted
    /// to be accurate. If all frames of the problem are, it is the duration, which need not be a
    /// whole number of frames. It is 0 only after [`Search::of`].
    ///
    /// The prediction is not a proof, because the bound on rounding errors is a measured one. A
    /// frame may be inaccurate a little earlier (the repository's test `plan_study`).
    pub horizon: f64,
    /// The reason why the horizon is not longer.
    pub limit: Limit,
    /// The cost of planning, in the unit of the [`Costs`]; at most the planning budget, except
    /// after [`Search::extend`].
    pub spent: f32,
}

impl Plan {
    /// Plans `problem` in one call: runs a [`Search`] to its end. The call takes as long as the
    /// search, which the planning budget limits.
    ///
    /// # Errors
    ///
    /// Refuses the inputs that [`Search::new`] and [`Search::advance`] refuse. Returns
    /// [`PlanError::NoMethod`] if no method within the budgets has an accurate frame.
    pub fn search(problem: &Problem, costs: &Costs, budget: &Budget) -> Result<Self, PlanError> {
        let mut search = Search::new(problem, costs, budget)?;
        loop {
            if let Some(plan) = search.advance(f32::INFINITY)? {
                return Ok(plan);
            }
        }
    }

    /// Returns the method and step count; the count is 1 for the closed form.
    #[must_use]
    pub fn stepping(&self) -> Stepping {
        Stepping {
            method: self.method,
            steps: self.steps.max(1),
        }
    }

    /// Returns the motion of the planned `problem` at its start, by [`method`](Self::method) with
    /// [`steps`](Self::steps) per frame of the problem; 0 counts as 1. Other fields of the plan are
    /// not used.
    ///
    /// A motion of another problem starts, too, but nothing is known of its accuracy.
    ///
    /// # Errors
    ///
    /// Refuses what [`PlannedRun::new`] refuses: a problem with an invalid pendulum, with a start
    /// that is not finite, with numbers out of the range of the method, with a rate of 0 or, in
    /// fixed point, with a step that is too long; for the closed form a pendulum without gravity;
    /// and a method that is not in [`Method::DRAWN`].
    pub fn run(&self, problem: &Problem) -> Result<PlannedRun, Error> {
        PlannedRun::new(problem, self.stepping())
    }
}
