//! `cargo simulate`: any motion as a table, computed here or by the firmware on a board.

mod board;
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

use anyhow::Context;

use crate::console::cli::{Refused, complain, say};
use crate::console::progress::Progress;

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
        Some(board) => board::readings(&plan.request, board, write),
    };
    drop(bar);
    // The rows until then are right, and stay.
    done.with_context(|| format!("after {rows} rows"))?;
    Ok(output.flush()?)
}
