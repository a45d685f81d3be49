//! The chips a plan is made for.

use double_pendulum::plan::{Limit, Plan, PlanError, Problem, plan};
use firmware::config::{CORTEX_M3, CORTEX_M4F, Processor, STM32F405};

/// A chip, by what a plan must know of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chip {
    /// What the user types.
    pub name: &'static str,
    /// In words.
    pub title: &'static str,
    /// Its clock, Hz.
    pub clock: f32,
    /// What its steps cost, and what may be spent.
    pub processor: Processor,
    /// Cycles of a step of the plain direction form in `f64` by RK4, which no plan needs.
    pub rk4_f64: f32,
}

/// The LM3S6965, without a floating-point unit.
pub const M3: Chip =
    Chip { name: "m3", title: "Cortex-M3 at 50 MHz", clock: 50e6, processor: CORTEX_M3, rk4_f64: 17_400.0 };
/// The STM32F405, with one for `f32`.
pub const M4F: Chip =
    Chip { name: "m4f", title: "Cortex-M4F at 168 MHz", clock: 168e6, processor: STM32F405, rk4_f64: 16_610.0 };
/// The slowest board's, with one.
pub const SLOW_M4F: Chip =
    Chip { name: "slow-m4f", title: "Cortex-M4F at 25 MHz", clock: 25e6, processor: CORTEX_M4F, ..M4F };
/// Every chip, the default first.
pub const CHIPS: [Chip; 3] = [M3, M4F, SLOW_M4F];

impl Chip {
    /// The plan that a board of this class finds; if nothing holds, what forbids finer steps.
    pub fn plan(&self, problem: &Problem) -> Result<Result<Plan, Limit>, PlanError> {
        match plan(problem, &self.processor.costs, &self.processor.budget(problem)) {
            Err(PlanError::NothingHolds { limit, .. }) => Ok(Err(limit)),
            found => found.map(Ok),
        }
    }
}
