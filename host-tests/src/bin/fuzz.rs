//! `cargo fuzz-all`: random input for everything that takes input, and a serial link that flips bits.

use std::process::ExitCode;

use anyhow::{Context, bail};
use clap::Parser;
use clap::builder::PossibleValuesParser;
use host_tests::commands::fuzz::{Flips, Search, TARGETS, Target, ThrottledCounter};
use host_tests::console::cli::{self, Refused, say};
use host_tests::console::progress::Bar;

/// The target that is no search: frames through a link that flips bits.
const FLIPS: &str = "flips";
/// Executions between two looks at the bar.
const BATCH: u64 = 1000;

/// Runs random input through everything that takes input from outside; nothing may panic, hang or break its promise.
#[derive(Debug, Parser)]
#[command(name = "cargo fuzz-all", after_help = "Example: cargo fuzz-all --target plans --executions 10000")]
struct Arguments {
    /// Executions of each target
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u32).range(1..))]
    executions: u32,
    /// Only this target; `flips` sends frames through a link that flips bits
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(TARGETS.map(|target| target.name).into_iter().chain([FLIPS])))]
    target: Option<String>,
    /// The chance that a bit is flipped
    #[arg(long, value_name = "P", default_value_t = 1e-4)]
    chance: f64,
    /// Keep an input for each new outcome in host-tests/corpus
    #[arg(long)]
    keep: bool,
}

fn main() -> ExitCode {
    cli::main(run)
}

fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let wanted = |name: &str| arguments.target.as_deref().is_none_or(|target| target == name);
    if !(0.0..1.0).contains(&arguments.chance) {
        bail!(Refused::because(format_args!("--chance {}: must be at least 0 and below 1", arguments.chance)));
    }
    for target in TARGETS.iter().filter(|target| wanted(target.name)) {
        search(*target, arguments)?;
    }
    if wanted(FLIPS) { flips(arguments) } else { Ok(()) }
}

fn search(target: Target, arguments: &Arguments) -> anyhow::Result<()> {
    let executions = u64::from(arguments.executions);
    let mut search = Search::new(target).context("the corpus")?;
    let bar = Bar::start(target.name, executions);
    for done in 1..=executions {
        if let Err(found) = search.step() {
            bail!("{}: a promise is broken by execution {done}: {:02x?}", target.name, found.input);
        }
        if done % BATCH == 0 {
            bar.advance(BATCH);
        }
    }
    drop(bar);
    let (name, outcomes) = (target.name, search.outcomes());
    say(format_args!("{name:10} {executions:>10} executions, {outcomes:>4} outcomes, nothing found"))?;
    if arguments.keep {
        search.keep().context("the corpus")?;
    }
    Ok(())
}

fn flips(arguments: &Arguments) -> anyhow::Result<()> {
    let executions = u64::from(arguments.executions);
    let mut link = Flips::new(1, arguments.chance);
    let bar = Bar::start(FLIPS, executions);
    for done in 1..=executions {
        link.send();
        if done % BATCH == 0 {
            bar.advance(BATCH);
        }
    }
    drop(bar);
    let ThrottledCounter { sent, damaged, received, forged, missed, lost } = link.tally();
    say(format_args!(
        "{FLIPS:10} {sent:>10} frames, {damaged} damaged, {received} received, {lost} missing by their numbers"
    ))?;
    if forged + missed > 0 || lost != damaged || received + damaged != sent {
        bail!("{forged} damaged frames were taken for good, {missed} good ones were missed");
    }
    Ok(())
}
