//! `cargo plan`: how to compute a scene as cheaply as may be.

use std::process::ExitCode;

use double_pendulum::plan::PlanError;
use host_tests::commands::plan::{DURATIONS, FOLLOWED, Options, broken, classes, fit, margins, scenes, study, words};
use host_tests::commands::table::Table;
use host_tests::console::cli::{self, Refused, say};
use host_tests::console::progress::Bar;

fn main() -> ExitCode {
    cli::main(run)
}

fn run(options: &Options) -> anyhow::Result<()> {
    let lines = match (options.study, options.fit) {
        (Some(count), _) => tables(options, count as usize)?,
        (None, Some(count)) => fitted(options, count as usize)?,
        (None, None) => {
            let (scene, plan) = options.plan().map_err(Refused::because)?;
            words(&scene, &plan, &options.target)
        }
    };
    Ok(lines.iter().try_for_each(say)?)
}

fn tables(options: &Options, count: usize) -> Result<Vec<String>, PlanError> {
    let bar = Bar::start("planning", count as u64);
    let scenes = scenes(options.seed.into(), DURATIONS).take(count);
    let cases = study(scenes, &options.target, || bar.advance(1))?;
    drop(bar);
    let chip = &options.target;
    let tables = [classes(&cases, chip)?, broken(&cases)];
    Ok(tables.iter().map(Table::markdown).collect())
}

fn fitted(options: &Options, count: usize) -> Result<Vec<String>, PlanError> {
    let bar = Bar::start("fitting", count as u64);
    let samples = fit(scenes(options.seed.into(), FOLLOWED).take(count), || bar.advance(1))?;
    drop(bar);
    Ok(vec![margins(&samples).markdown()])
}
