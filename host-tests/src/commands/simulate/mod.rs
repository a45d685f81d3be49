//! `cargo simulate`: any motion as a table, computed here or, the same request, by the firmware on an emulated board.

mod number;
mod options;
mod request;
mod start;
mod table;
mod tolerance;

pub use number::Number;
pub use options::{Place, SimulateOptions};
pub use request::{Plan, plan};
pub use start::{Pair, StartOptions, option_of};
pub use tolerance::choose;

use std::io::{self, BufWriter, Write};
use std::time::Duration;

use anyhow::{Context, bail, ensure};
use firmware::job::{Reading, Request};
use firmware::protocol::{Answer, Command};

use crate::console::cli::{Refused, complain, say};
use crate::console::progress::Progress;
use crate::emulator::boards::Board;
use crate::emulator::qemu::{Clock, Machine, Settings};
use crate::emulator::toolchain;
use crate::link::refusal;

pub fn run(options: &SimulateOptions) -> anyhow::Result<()> {
    if options.list {
        return Ok(say(table::methods())?);
    }
    let planned = match &options.tolerance {
        Some(tolerance) => choose(options, tolerance).map(|(plan, _)| plan),
        None => plan(options),
    };
    let plan = planned.map_err(|error| Refused::because(format_args!("{error:#}")))?;
    plan.note.iter().for_each(complain);
    let mut output = BufWriter::new(io::stdout().lock());
    let (bar, mut rows) = (Progress::of("rows", u64::from(plan.request.samples) + 1), 0);
    let mut write = |reading: &_| {
        bar.advance(1);
        if rows == 0 {
            writeln!(output, "{}", table::header(options))?;
        }
        writeln!(output, "{}", table::row(&plan, options, rows, reading))?;
        rows += 1;
        Ok(())
    };
    let done = match options.place {
        None => plan.request.readings(|reading| Ok(write(reading)?)),
        Some(board) => on_board(&plan.request, board, write),
    };
    drop(bar);
    // The rows until then are right, and stay.
    done.with_context(|| format!("after {rows} rows"))?;
    Ok(output.flush()?)
}

/// To start QEMU and to send the rows.
const OVERHEAD: Duration = Duration::from_secs(120);
/// A step takes at most 200,000 instructions (f64 in steps of order 8, `cargo count`); a busy host executes 10 million a
/// second.
const PER_STEP: Duration = Duration::from_millis(20);

/// Sends the request to the firmware on `board` and gives each reading that comes back to `row`.
fn on_board(
    request: &Request,
    board: &'static Board,
    mut row: impl FnMut(&Reading) -> io::Result<()>,
) -> anyhow::Result<()> {
    let toolchain = toolchain::set_up()?;
    let elf = toolchain.build_for(board)?;
    let limit = OVERHEAD.saturating_add(PER_STEP.saturating_mul(request.stride.saturating_mul(request.samples)));
    let settings = Settings { qemu: &toolchain.qemu, board, elf: &elf, clock: Clock::Real, debugger: true, limit };
    let mut machine = Machine::start(&settings)?;
    // Its first frame says that it listens.
    machine.next_frame().context(board.name)?;
    machine.send(1, Command::Simulate(*request))?;
    let mut expected = 0;
    while expected <= request.samples {
        match machine.next_answer().context(board.name)? {
            (_, Answer::Refused(field)) => bail!("{}: the board refuses the request: {}", board.name, refusal(field)),
            (_, Answer::Sample { index, reading }) => {
                ensure!(index == expected, "{}: row {expected} was lost on the way", board.name);
                row(&reading)?;
                expected += 1;
            }
            _ => {}
        }
    }
    Ok(())
}
