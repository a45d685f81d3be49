//! Planning: finds the cheapest method whose frames are accurate, and predicts its accuracy
//! horizon.
//!
//! A frame is accurate if both bobs are within a tolerance of the exact motion.
//!
//! # Measurement of errors
//!
//! The growth of an error depends on the individual motion. Of two starts with the same energy, one
//! may be regular and the other chaotic, and no formula in the energy distinguishes them. A
//! [`Search`] therefore runs the motion itself, in coarse steps and in fine ones, and compares the
//! positions of the bobs:
//!
//! | error | measurement |
//! |---|---|
//! | methods in 32 bits, closed form | the distance to a run in 64 bits, plus its error |
//! | the same, without such a run | the distances to runs in finer steps, inputs perturbed |
//! | truncation in 64 bits | the distance to a second run in 64 bits, in other steps |
//! | rounding in 64 bits | its size where it arises, times the later growth of small distances |
//!
//! The runs in finer steps are used if planning cannot pay for a run in 64 bits, if that would be
//! too expensive, or to find out first how fast errors grow. Their inputs are perturbed by an ulp.
//! There are three of them, or fewer if planning cannot pay for three. With fewer runs, the bound
//! is a larger multiple of the distance.
//!
//! No run is assumed to be exact. Errors grow along a single direction, and along it two equally
//! wrong runs may agree by chance. The growth is measured by *shadows*: motions in 32 bits that are
//! kept close to the one in 64 bits.
//!
//! # Choice of the method
//!
//! The search starts with coarse steps and refines them until a candidate is accurate to the end of
//! the problem. If several candidates of that trial are, it chooses the cheapest of them. If no
//! candidate is accurate to the end, as in chaotic motions, it chooses the longest horizon that is
//! worth its cost. If no method within the budgets has an accurate frame, it returns
//! [`PlanError::NoMethod`].
//!
//! The first steps are usually as long as four steps of
//! [`Pendulum::admissible_step`](crate::Pendulum::admissible_step). In such a step the fastest rate
//! that the energy allows, a proven bound, advances a phase by a radian. If the budgets do not pay
//! for steps of this length, the first steps are up to 16 times as long. If a frame cannot pay for
//! these either, they are up to 512 times as long. In all first steps the faster normal mode
//! advances by at most a radian. The first trial uses these steps and, if it has a run in 64 bits,
//! steps of a half and a quarter of their length. Its method is compensated `f32` or 32 bits of
//! fixed point, by their costs. If fixed point refuses the motion, or all steps that a frame can
//! pay for, it is `f32`.
//!
//! The search changes to 64 bits if three finer runs show that errors grow faster than the cube of
//! the time, as in chaotic motions; if rounding is the larger error; if 64 bits cost less; or if 32
//! bits fail early and planning can pay for 64 bits but not for finer steps in 32 bits as well,
//! unless 64 bits are too expensive and finer steps gain much. It then takes the finest steps that
//! both budgets can pay for. If a frame cannot pay for 64 bits, or if these refuse the motion, the
//! search continues in `f32`. It refines the steps as long as finer ones help and a frame can pay
//! for them.
//!
//! Planning needs no heap. It is divided into pieces that a busy caller can afford ([`Search`]).
//! The caller provides the cost of a step: [`Costs`] is a price list in any unit. The kernel has
//! the lists of three processors, in cycles.
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
mod error;
mod prices;
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
pub use run::PlannedRun;
pub use search::Search;

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
    /// It is at most the frame budget, unless the method was fixed by the caller ([`Search::of`]).
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
    /// after [`Search::extend`]. It is the cost of steps and preparations. To compare a frame,
    /// with its directions by the closed form, counts as nothing ([`Search::advance`]).
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
    /// that is not finite, with numbers out of the range of the method, with a rate of 0 or, in fixed point, with a step that is too long; for the closed
    /// form a pendulum without gravity; and a method that is not in [`Method::DRAWN`].
    pub fn run(&self, problem: &Problem) -> Result<PlannedRun, Error> {
        PlannedRun::new(problem, self.stepping())
    }
}
