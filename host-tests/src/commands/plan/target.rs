//! The chips a plan is made for.

use double_pendulum::plan::{Budget, Costs, Limit, Plan, PlanError, Problem, plan};
use firmware::config::{CORTEX_M3, CORTEX_M4F, FRAME_SHARE};

/// A chip, by what a plan must know of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chip {
    /// What the user types.
    pub name: &'static str,
    /// In words.
    pub title: &'static str,
    /// Its clock, Hz.
    pub clock: f32,
    /// Cycles of a step.
    pub costs: Costs,
    /// Cycles of a step of the plain direction form in `f64` by RK4, which no plan needs.
    pub rk4_f64: f32,
}

/// The LM3S6965, without a floating-point unit.
pub const M3: Chip =
    Chip { name: "m3", title: "Cortex-M3 at 50 MHz", clock: 50e6, costs: CORTEX_M3, rk4_f64: 17_400.0 };
/// The STM32F405, with one for `f32`.
pub const M4F: Chip =
    Chip { name: "m4f", title: "Cortex-M4F at 168 MHz", clock: 168e6, costs: CORTEX_M4F, rk4_f64: 16_610.0 };
/// Every chip, the default first.
pub const CHIPS: [Chip; 2] = [M3, M4F];

impl Chip {
    /// What it may spend with `rate` frames per second and `planning` seconds for looking ahead.
    pub fn budget(&self, rate: u16, planning: f32) -> Budget {
        Budget { frame: FRAME_SHARE * self.clock / f32::from(rate), planning: planning * self.clock }
    }

    /// The plan for this chip with `planning` seconds for looking ahead; if nothing holds, what forbids finer steps.
    pub fn plan(&self, problem: &Problem, planning: f32) -> Result<Result<Plan, Limit>, PlanError> {
        match plan(problem, &self.costs, &self.budget(problem.rate, planning)) {
            Err(PlanError::NothingHolds { limit, .. }) => Ok(Err(limit)),
            found => found.map(Ok),
        }
    }
}
