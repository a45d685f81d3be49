//! `cargo plan`: how to compute a scene as cheaply as may be.

use std::process::ExitCode;

use double_pendulum::plan::PlanError;
use host_tests::commands::plan::{CHIPS, DURATIONS, Options, scenes, study, summary, violations, words};
use host_tests::commands::table::Table;
use host_tests::console::cli::{self, Refused, say};
use host_tests::console::progress::Bar;

fn main() -> ExitCode {
    cli::main(run)
}

fn run(options: &Options) -> anyhow::Result<()> {
    let lines = match options.study {
        Some(count) => tables(options, count)?,
        None => {
            let (scene, plan) = options.plan().map_err(Refused::because)?;
            words(&scene, &plan, &options.target)
        }
    };
    Ok(lines.iter().try_for_each(say)?)
}

fn tables(options: &Options, count: u32) -> Result<Vec<String>, PlanError> {
    let bar = Bar::start("planning", count.into());
    let cases = study(scenes(options.seed.into(), DURATIONS).take(count as usize), &CHIPS, || bar.advance(1))?;
    drop(bar);
    Ok([summary(&cases), violations(&cases)].iter().map(Table::markdown).collect())
}
