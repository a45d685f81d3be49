//! `cargo plan`: how to compute a scene as cheaply as may be.

use std::process::ExitCode;

use host_tests::commands::plan::{CHIPS, DURATIONS, Options, scenes, study, summary, words};
use host_tests::console::cli::{self, Refused, complain, say};
use host_tests::console::progress::Bar;

fn main() -> ExitCode {
    cli::main(run)
}

fn run(options: &Options) -> anyhow::Result<()> {
    let Some(count) = options.study else {
        let (scene, plan) = options.plan().map_err(Refused::because)?;
        return Ok(words(&scene, &plan, &options.target).iter().try_for_each(say)?);
    };
    let bar = Bar::start("planning", count.into());
    let cases = study(scenes(options.seed.into(), DURATIONS).take(count as usize), &CHIPS, || bar.advance(1))?;
    drop(bar);
    // Every violation, none hidden.
    cases.iter().filter(|case| case.is_violation()).for_each(|case| complain(format_args!("violation: {case:?}")));
    Ok(say(summary(&cases).markdown())?)
}
