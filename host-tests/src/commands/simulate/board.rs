//! The same request, computed by the firmware on an emulated board.

use std::io;
use std::time::Duration;

use anyhow::{Context, bail, ensure};
use firmware::job::Reading;
use firmware::protocol::{Field, Frame, Refused, Sample};

use super::Plan;
use crate::emulator::boards::Board;
use crate::emulator::qemu::{Clock, Machine, Settings};
use crate::emulator::toolchain;

/// Any number will do: the machine is ours alone.
const REQUEST: u16 = 1;
/// To start QEMU and to send the rows.
const OVERHEAD: Duration = Duration::from_secs(120);
/// A step takes at most 200,000 instructions (f64 in steps of order 8, `cargo count`); a busy host executes 10 million a
/// second.
const PER_STEP: Duration = Duration::from_millis(20);

/// Sends the request to the firmware on `board` and gives each reading that comes back to `row`.
pub fn on_board(
    plan: &Plan,
    board: &'static Board,
    mut row: impl FnMut(&Reading) -> io::Result<()>,
) -> anyhow::Result<()> {
    let (toolchain, _) = toolchain::set_up()?;
    let elf = toolchain.build_for(board)?;
    let steps = plan.request.stride.saturating_mul(plan.request.samples);
    let limit = OVERHEAD.saturating_add(PER_STEP.saturating_mul(steps));
    let clock = Clock::Real;
    let mut machine =
        Machine::start(&Settings { qemu: toolchain.qemu(), board, elf: &elf, clock, debugger: true, limit })?;

    // Its first frame says that it listens.
    machine.wait_for::<Frame>().context(board.name)?;
    machine.serial.send(&plan.request.message(REQUEST))?;
    for index in 0..=plan.request.samples {
        let sample = next_sample(&mut machine).context(board.name)?;
        ensure!(sample.index == index, "{}: row {index} was lost on the way", board.name);
        row(&Reading { state: sample.state, velocities: sample.velocities, energy: sample.energy })?;
    }
    machine.quit()
}

fn next_sample(machine: &mut Machine) -> anyhow::Result<Sample> {
    loop {
        let message = machine.receive()?;
        if let Some(Refused { field, .. }) = message.read() {
            bail!("the board refuses the request: {}", Field::from_code(field).map_or("unknown field", Field::name));
        }
        if let Some(sample) = message.read() {
            return Ok(sample);
        }
    }
}
