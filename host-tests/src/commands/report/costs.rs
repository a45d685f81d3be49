//! What a step costs on the target: counted, never timed.

use double_pendulum::Method;
use firmware::job::Request;

use super::accuracy::{rates, request, usual_rate};
use super::scene::Scene;
use super::{compared, parallel};
use crate::commands::count::{CountError, ERROR_BAR, FULL_CYCLE, StepCost, Target, affordable_steps, step_cost};
use crate::commands::table::Table;
use crate::emulator::boards::Board;

/// The finest step counted is 2^-this s.
const FINEST: u32 = 13;

/// One method on one board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// The method.
    pub method: Method,
    /// The motion: that of fixed point matters, for rods and masses unlike each other are stepped by other code.
    pub scene: &'static Scene,
    /// The board.
    pub board: &'static Board,
    /// Per step.
    pub step: StepCost,
}

/// Counts every method on the first of `scenes`, and fixed point on all, each target on a thread of its own; `tick` is
/// called after each method.
pub fn count(targets: &[Target], scenes: &'static [Scene], tick: &(dyn Fn() + Sync)) -> Result<Vec<Cost>, CountError> {
    let on_target = |target: &Target| {
        let mut costs = Vec::new();
        for method in compared() {
            let scenes = scenes.iter().take(if method.is_fixed_point() { scenes.len() } else { 1 });
            for (scene, request) in scenes.filter_map(|scene| Some((scene, counted_request(method, scene)?))) {
                costs.push(Cost { method, scene, board: target.board, step: one(target, &request)? });
            }
            tick();
        }
        Ok(costs)
    };
    Ok(parallel(targets, on_target).into_iter().collect::<Result<Vec<_>, CountError>>()?.concat())
}

/// With so many steps a second as are usual, or the fewest above that it accepts.
fn counted_request(method: Method, scene: &Scene) -> Option<Request> {
    let rates = rates(method, FINEST).filter(|&rate| rate >= usual_rate(method));
    let accepts = |request: &Request| Request { stride: 1, samples: 1, ..*request }.crc().is_ok();
    rates.map(|rate| request(method, scene, rate)).find(accepts)
}

/// The cost of `method` on `board` in `scene`, or in the first that it was counted in.
pub fn of<'a>(costs: &'a [Cost], method: Method, scene: &Scene, board: &Board) -> Option<&'a Cost> {
    let mut own = costs.iter().filter(|cost| cost.method == method && cost.board == board);
    own.clone().find(|cost| cost.scene == scene).or_else(|| own.next())
}

/// What a step of `request` costs on `target`, over as many steps as can be afforded.
pub fn one(target: &Target, request: &Request) -> Result<StepCost, CountError> {
    let whole = Request { samples: 1, stride: FULL_CYCLE, ..*request };
    let stride = affordable_steps(target, &whole)?;
    step_cost(target, &Request { stride, ..whole })
}

/// The table of costs.
pub fn table(costs: &[Cost]) -> Table {
    let row = |cost: &Cost| {
        let StepCost { instructions, cycles, stalls, hot_bytes, code_bytes, stack_bytes } = cost.step;
        let counts = [instructions, cycles, stalls].map(|count| format!("{count:.0}"));
        let bytes = [hot_bytes, code_bytes, stack_bytes].map(|count| count.to_string());
        let mut row = vec![cost.method.to_string(), cost.scene.name.to_owned(), cost.board.cpu.to_owned()];
        row.extend(counts.into_iter().chain(bytes));
        row
    };
    Table {
        name: "costs",
        title: String::from("Cost of one step"),
        note: format!(
            "256 steps a second, 16 of high orders. Instructions are counted in QEMU and exact. {ERROR_BAR} Stalls are \
             those of the cycles that wait for the floating-point unit. Hot bytes: instructions executed. Code bytes: \
             whole functions with constants."
        ),
        columns: vec![
            "method",
            "scene",
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
