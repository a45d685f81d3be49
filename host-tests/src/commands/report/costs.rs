//! What a step costs on the target: counted, never timed.

use firmware::job::{Request, Row};

use super::accuracy::request;
use super::scene::Scene;
use super::{compared_rows, parallel};
use crate::commands::count::{CountError, ERROR_BAR, FULL_CYCLE, StepCost, Target, affordable_steps, step_cost};
use crate::commands::table::Table;
use crate::emulator::boards::Board;

/// The step size the counting is done at: 2^-8 s.
pub const HALVINGS: u32 = 8;

/// One arithmetic on one board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The arithmetic.
    pub row: Row,
    /// The board.
    pub board: &'static Board,
    /// Per step.
    pub step: StepCost,
}

/// Counts every arithmetic on `scene`, each target on a thread of its own; `tick` is called after each.
pub fn count(targets: &[Target], scene: &Scene, tick: &(dyn Fn() + Sync)) -> Result<Vec<Cost>, CountError> {
    let on_target = |target: &Target| {
        let counted = compared_rows().map(|row| {
            let step = one(target, &request(row, scene, HALVINGS))?;
            tick();
            Ok(Cost { row, board: target.board, step })
        });
        counted.collect::<Result<Vec<_>, CountError>>()
    };
    Ok(parallel(targets, on_target).into_iter().collect::<Result<Vec<_>, _>>()?.concat())
}

/// What a step of `request` costs on `target`, over as many steps as can be afforded.
pub fn one(target: &Target, request: &Request) -> Result<StepCost, CountError> {
    let whole = Request { samples: 1, stride: FULL_CYCLE, ..*request };
    let stride = affordable_steps(target, &whole)?;
    step_cost(target, &Request { stride, ..whole })
}

/// The table of costs.
pub fn table(costs: &[Cost], scene: &Scene) -> Table {
    let row = |cost: &Cost| {
        let StepCost { instructions, cycles, stalls, hot_bytes, code_bytes, stack_bytes } = cost.step;
        let counts = [instructions, cycles, stalls].map(|count| format!("{count:.0}"));
        let bytes = [hot_bytes, code_bytes, stack_bytes].map(|count| count.to_string());
        let mut row = vec![cost.row.to_string(), cost.board.cpu.to_owned()];
        row.extend(counts.into_iter().chain(bytes));
        row
    };
    Table {
        name: "costs",
        title: String::from("Cost of one step"),
        note: format!(
            "Scene {}, step 2^-{HALVINGS} s. Instructions are counted in QEMU and exact. {ERROR_BAR} Stalls are those of \
             the cycles that wait for the floating-point unit. Hot bytes: instructions executed. Code bytes: whole \
             functions with constants.",
            scene.name
        ),
        columns: vec![
            "arithmetic",
            "processor",
            "instructions",
            "cycles (estimate)",
            "stalls",
            "hot bytes",
            "code bytes",
            "stack bytes",
        ],
        rows: costs.iter().map(row).collect(),
    }
}
