//! The chips a plan is made for.

use double_pendulum::plan::{Limit, Plan, PlanError, Problem};
use firmware::config::{CORTEX_M0PLUS, CORTEX_M3, CORTEX_M4F, Processor, STM32F405};

/// A chip, by what a plan must know of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chip {
    pub name: &'static str,
    pub title: &'static str,
    pub clock: f32,
    /// What its steps cost, and what may be spent.
    pub processor: Processor,
}

/// The LM3S6965, without a floating-point unit.
pub const M3: Chip = Chip { name: "m3", title: "Cortex-M3 at 50 MHz", clock: 50e6, processor: CORTEX_M3 };
/// The STM32F405, with one for `f32`.
pub const M4F: Chip = Chip { name: "m4f", title: "Cortex-M4F at 168 MHz", clock: 168e6, processor: STM32F405 };
/// The slowest board's, with one.
pub const SLOW_M4F: Chip = Chip { name: "slow-m4f", title: "Cortex-M4F at 25 MHz", clock: 25e6, processor: CORTEX_M4F };
/// The Raspberry Pi Pico's, whose products have 32 bits only.
pub const PICO: Chip = Chip { name: "pico", title: "Cortex-M0+ at 125 MHz", clock: 125e6, processor: CORTEX_M0PLUS };
/// Every chip, the default first.
pub const CHIPS: [Chip; 4] = [M3, M4F, SLOW_M4F, PICO];

impl Chip {
    /// The plan that a board of this class finds; if no method meets the tolerance, what forbids finer steps.
    pub fn plan(&self, problem: &Problem) -> Result<Result<Plan, Limit>, PlanError> {
        match Plan::search(problem, &self.processor.costs, &self.processor.budget(problem)) {
            Err(PlanError::NoMethod { limit, .. }) => Ok(Err(limit)),
            found => found.map(Ok),
        }
    }
}
