//! `cargo simulate`: any motion as a table.

use std::io::{self, BufWriter, ErrorKind};
use std::process::ExitCode;

use host_tests::commands::simulate::{Options, Place, Plan, Table, on_board, on_host, plan};
use host_tests::console::cli;
use host_tests::console::progress::Bar;
use host_tests::emulator::toolchain::SetupError;

fn main() -> ExitCode {
    let options = match cli::parse::<Options>() {
        Ok(options) => options,
        Err(code) => return code,
    };
    let plan = match plan(&options) {
        Ok(plan) => plan,
        Err(reason) => return cli::refuse(format_args!("error: {reason}")),
    };
    if let Some(warning) = plan.warning(&options) {
        eprintln!("warning: {warning}");
    }
    match run(&options, &plan) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_closed_output(&error) => ExitCode::SUCCESS,
        Err(error) if error.is::<SetupError>() => cli::refuse(error),
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options, plan: &Plan) -> anyhow::Result<()> {
    let output = BufWriter::new(io::stdout().lock());
    let mut table = Table::new(output, plan.request.arithmetic, plan.every.clone(), options.bits);
    let bar = Bar::start("rows", u64::from(plan.request.samples) + 1);
    let row = |reading: &_| {
        bar.advance(1);
        table.row(reading)
    };
    match options.place {
        Place::Host => on_host(plan, row)?,
        Place::Board(board) => on_board(plan, board, row)?,
    }
    drop(bar);
    Ok(table.finish()?)
}

/// The reader of our output has seen enough.
fn is_closed_output(error: &anyhow::Error) -> bool {
    error.downcast_ref::<io::Error>().is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
}
