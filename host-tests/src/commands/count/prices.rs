//! The planner's price lists, counted.

use std::path::PathBuf;
use std::time::Duration;

use anyhow::{Context, Result};
use double_pendulum::plan::Costs;
use double_pendulum::{Method, Parameters};
use firmware::job::Request;
use firmware::protocol::Command;
use rayon::prelude::*;

use super::{FULL_CYCLE, Target, affordable_cost, calls_in_next};
use crate::commands::table::between;
use crate::emulator::boards::Board;
use crate::emulator::qemu::{Clock, Lockstep, Settings};
use crate::emulator::toolchain::{Toolchain, workspace};
use cycles::Image;

const LIMIT: Duration = Duration::from_secs(1800);
/// What stands before and after the lists in their file.
const MARKS: [&str; 2] = ["// made by cargo count --write-prices\n", "// so far\n"];

/// What a step costs by each method that a plan chooses from, on one board for each kind of core.
pub fn prices(toolchain: &Toolchain) -> Result<Vec<(&'static Board, Costs)>> {
    let targets = Target::build_all(toolchain)?;
    targets.par_iter().map(|target| Ok((target.board, on(target, toolchain)?))).collect()
}

fn on(target: &Target, toolchain: &Toolchain) -> Result<Costs> {
    let step = |method| {
        let parameters = Parameters::equal_rods(1.0, 1.0, 9.81);
        let (angles, velocities, dt) = ([0.5; 2], [0.0; 2], 1.0 / 256.0);
        let request = Request { method, parameters, angles, velocities, dt, stride: FULL_CYCLE, samples: 1 };
        anyhow::Ok(affordable_cost(target, &request)?.cycles as f32)
    };
    let (fixed64, preparation) = in_application(target.board, toolchain)?;
    Ok(Costs {
        closed_form: step(Method::ClosedFormF32)?,
        direction_plain: step(Method::Rk4F32DirectionPlain)?,
        direction: step(Method::Rk4F32Direction)?,
        fixed32: step(Method::Rk4Fixed32)?,
        fixed64,
        preparation,
    })
}

/// What only the application does: a step in 64 bits of the plans' order, and the preparation of a motion, the most expensive.
fn in_application(board: &'static Board, toolchain: &Toolchain) -> Result<(f32, f32)> {
    let elf = toolchain.build_for(board)?;
    let image = Image::read(&elf)?;
    let qemu = toolchain.qemu();
    let settings = Settings { qemu, board, elf: &elf, clock: Clock::Counted, debugger: true, limit: LIMIT };
    let mut machine = Lockstep::start(&settings)?;
    let most = |machine: &mut Lockstep, function: &str| {
        let (_, calls) = calls_in_next(machine, &image, board.core(), function)?;
        anyhow::Ok(calls.iter().map(|call| call.cycles as f32).fold(0.0, f32::max))
    };
    machine.next_frame()?;
    let step = most(&mut machine, "Fixed64State::advance")?;
    let mut prepared: f32 = 0.0;
    for &method in Method::DRAWN {
        machine.machine().serial.send(1, Command::Method(Some(method)))?;
        machine.run_to(image.function("PlannedRun::new")?.address)?;
        prepared = prepared.max(most(&mut machine, "PlannedRun::new")?);
    }
    Ok((step, prepared))
}

/// Writes them into the firmware's source; the file.
pub fn write_prices(prices: &[(&Board, Costs)]) -> Result<PathBuf> {
    let path = workspace().join("firmware/src/prices.rs");
    let old = std::fs::read_to_string(&path)?;
    let lists: String = prices.iter().map(|(board, costs)| list(board, costs)).collect();
    let new = between(&old, MARKS, &lists).with_context(|| format!("{} has no place for them", path.display()))?;
    std::fs::write(&path, new)?;
    Ok(path)
}

fn list(board: &Board, costs: &Costs) -> String {
    let title = board.core().name();
    let name = title.to_uppercase().replace('-', "_").replace('+', "PLUS");
    format!("/// A {title}.\npub const {name}: Costs = {costs:#.1?};\n")
}
