//! `cargo simulate`: any motion as a table.

use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use anyhow::Context;
use host_tests::commands::simulate::{Plan, SimulateOptions, choose, header, list, on_board, plan, row};
use host_tests::console::cli::{self, Refused, complain, say};
use host_tests::console::progress::Bar;

fn main() -> ExitCode {
    cli::main(run)
}

fn run(options: &SimulateOptions) -> anyhow::Result<()> {
    if options.list {
        return Ok(say(list())?);
    }
    let plan = planned(options).map_err(|error| Refused::because(format_args!("{error:#}")))?;
    let mut output = BufWriter::new(io::stdout().lock());
    let (bar, mut rows) = (Bar::start("rows", u64::from(plan.request.samples) + 1), 0);
    let mut write = |reading: &_| {
        bar.advance(1);
        if rows == 0 {
            writeln!(output, "{}", header(options))?;
        }
        writeln!(output, "{}", row(&plan, options, rows, reading))?;
        rows += 1;
        Ok(())
    };
    let done = match options.place {
        None => plan.request.readings(|reading| Ok(write(reading)?)),
        Some(board) => on_board(&plan, board, write),
    };
    drop(bar);
    // The rows until then are right, and stay.
    done.with_context(|| format!("after {rows} rows"))?;
    Ok(output.flush()?)
}

/// The motion to compute; warnings about it go to stderr first.
fn planned(options: &SimulateOptions) -> anyhow::Result<Plan> {
    if let Some(tolerance) = &options.tolerance {
        let choice = choose(options, tolerance)?;
        complain(&choice);
        return Ok(choice.plan);
    }
    let plan = plan(options)?;
    if let Some(warning) = plan.warning(options) {
        complain(format_args!("warning: {warning}"));
    }
    Ok(plan)
}
