//! Model only what a scene needs: the cheapest way to compute it that is right to half a pixel, and until when it is.
//!
//! How fast an error grows is a property of the very motion: of two scenes with the same energy one may be regular and
//! the other chaotic, and no formula in the energy tells them apart. So [`plan`] looks ahead. It runs the scene itself,
//! from coarse steps to fine ones, beside twins that have other errors, and compares what would be drawn:
//!
//! | error of | is measured by |
//! |---|---|
//! | the step | a twin with half the step |
//! | rounding, that of the numbers given too | two twins with the same step, whose given numbers are half an ulp off |
//! | the closed form, plain `f32`, the angle form | the distance to the compensated direction form, which has the errors above |
//!
//! The coarsest step at which anything stays within half a pixel to the end of the scene decides; of all that does the
//! cheapest is taken. If nothing does (a chaotic scene), what does longest is. The search begins at a step that resolves
//! all motions of the scene's energy, by the proven bound of [`Pendulum::admissible_step`](crate::Pendulum::admissible_step),
//! and goes over to `f64` where rounding is the larger error. Looking ahead costs a few times what the scene itself does in
//! the cheap arithmetic, no heap, and is done a frame at a time ([`Search`]).
//!
//! Over 2,000 scenes of all kinds half a pixel is kept until the promised horizon in every one (`cargo plan --study 2000
//! --seed 1 --target m4f`); test `plan_study` draws other 200 with every run.
//!
//! Equal rods are no choice of their own: in the [forms](crate::form) rods of any lengths cost what equal ones do.
//!
//! ```
//! use double_pendulum::plan::{Budget, Costs, Problem, Method, plan};
//! use double_pendulum::{Motion, Parameters};
//!
//! let pendulum = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 };
//! let small = Problem { pendulum, start: Motion::at_rest(0.05, 0.05), height: 64.0, duration: 10.0, rate: 60 };
//! let found = plan(&small, &Costs::CORTEX_M3, &Budget::half_of(50e6, 60, 60.0))?;
//! assert_eq!(found.way, Method::ClosedForm);
//! assert_eq!(found.horizon, 10.0);
//! # Ok::<(), double_pendulum::Error>(())
//! ```

mod cost;
mod pass;
mod problem;
mod run;
mod search;
mod shadowed_run;

pub use cost::{Budget, Costs, Method};
pub use problem::{HALF_PIXEL, Problem};
pub use run::Directions;
pub use search::{Limit, Plan, Search};
pub use shadowed_run::{ErrorEstimate, MARGIN, ShadowedRun};

use crate::error::Error;

/// The plan for `scene` at once: [`Search`] to its end.
///
/// Refuses what [`Search::new`] refuses.
pub fn plan(problem: &Problem, costs: &Costs, budget: &Budget) -> Result<Plan, Error> {
    let mut search = Search::new(problem, costs, budget)?;
    loop {
        if let Some(plan) = search.advance(f32::INFINITY)? {
            return Ok(plan);
        }
    }
}
