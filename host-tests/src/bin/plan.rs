//! `cargo plan`: how to compute a scene as cheaply as may be.

use std::process::ExitCode;

use double_pendulum::Error;
use host_tests::cli;
use host_tests::planning::{DURATIONS, Options, broken, classes, study, words};
use host_tests::simulate::progress;

fn main() -> ExitCode {
    let options = match cli::parse::<Options>() {
        Ok(options) => options,
        Err(code) => return code,
    };
    let lines = match options.study {
        None => options.plan().map(|(scene, plan)| words(&scene, &plan, &options.target)),
        Some(count) => tables(&options, count).map_err(anyhow::Error::new),
    };
    match lines {
        Ok(lines) => {
            lines.iter().for_each(|line| println!("{line}"));
            ExitCode::SUCCESS
        }
        Err(reason) => cli::refuse(format_args!("error: {reason}")),
    }
}

fn tables(options: &Options, count: usize) -> Result<Vec<String>, Error> {
    let bar = progress(count as u64);
    let cases = study(options.seed, count, DURATIONS, &options.target, || bar.inc(1))?;
    bar.finish_and_clear();
    Ok(vec![classes(&cases, &options.target)?.markdown(), broken(&cases).markdown()])
}
