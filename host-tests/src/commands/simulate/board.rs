//! The same request, computed by the firmware on an emulated board.

use std::io;
use std::time::Duration;

use anyhow::{Context, bail, ensure};
use firmware::job::{Reading, Request};
use firmware::protocol::{Frame, Sample};

use crate::emulator::boards::Board;
use crate::emulator::qemu::{Clock, Machine, Settings};
use crate::emulator::toolchain;

/// To start QEMU and to send the rows.
const OVERHEAD: Duration = Duration::from_secs(120);
/// A step takes at most 200,000 instructions (f64 in steps of order 8, `cargo count`); a busy host executes 10 million a
/// second.
const PER_STEP: Duration = Duration::from_millis(20);

/// Sends the request to the firmware on `board` and gives each reading that comes back to `row`.
pub fn readings(
    request: &Request,
    board: &'static Board,
    mut row: impl FnMut(&Reading) -> io::Result<()>,
) -> anyhow::Result<()> {
    let (toolchain, _) = toolchain::set_up()?;
    let elf = toolchain.build_for(board)?;
    let limit = OVERHEAD.saturating_add(PER_STEP.saturating_mul(request.stride.saturating_mul(request.samples)));
    let settings = Settings { qemu: toolchain.qemu(), board, elf: &elf, clock: Clock::Real, debugger: true, limit };
    let mut machine = Machine::start(&settings)?;
    // Its first frame says that it listens.
    machine.wait_for::<Frame>().context(board.name)?;
    machine.serial.send(&request.message(1))?;
    let mut expected = 0;
    while expected <= request.samples {
        let message = machine.receive().context(board.name)?;
        if let Some(field) = message.refused() {
            bail!("{}: the board refuses the request: {field}", board.name);
        }
        if let Some(Sample { index, reading, .. }) = message.read() {
            ensure!(index == expected, "{}: row {expected} was lost on the way", board.name);
            row(&reading)?;
            expected += 1;
        }
    }
    machine.quit()
}
