//! `cargo plan`: how to compute a scene as cheaply as may be.

use std::process::ExitCode;

use clap::{Parser, value_parser};
use host_tests::commands::plan::{CHIPS, DURATIONS, SceneOptions, scenes, study, summary, words};
use host_tests::console::cli::{self, Refused, complain, say};
use host_tests::console::progress::Bar;

const EXAMPLES: &str = "Examples:
  cargo plan --angles 90,90 --degrees --height 64 --duration 10
  cargo plan --masses 1,2.75 --angles 171,171 --degrees --target m4f
  cargo plan --scene figure-7 --target pico
  cargo plan --study 100";

/// Says how to compute a motion as cheaply as may be, right to half a pixel about the exact one, and until when that is
/// expected; or that nothing the chip can afford is right in any frame, which is an answer, too (exit code 0).
///
/// Numbers are decimals (0.25, 1e-3) or fractions (1/256).
#[derive(Debug, Parser)]
#[command(name = "cargo plan", after_help = EXAMPLES)]
struct Options {
    /// What moves.
    #[command(flatten)]
    scene: SceneOptions,
    /// Plan this many scenes of all kinds for every chip instead, carry them out beside the reference, and print what came of it
    #[arg(long, value_name = "SCENES", conflicts_with_all = ["scene", "target"], value_parser = value_parser!(u32).range(1..))]
    study: Option<u32>,
    /// Which scenes
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = value_parser!(u32).range(0..))]
    seed: u32,
}

fn main() -> ExitCode {
    cli::main(run)
}

fn run(options: &Options) -> anyhow::Result<()> {
    let Some(count) = options.study else {
        let (scene, plan) = options.scene.plan().map_err(Refused::because)?;
        return Ok(words(&scene, &plan, &options.scene.target).iter().try_for_each(say)?);
    };
    let bar = Bar::start("planning", count.into());
    let cases = study(scenes(options.seed.into(), DURATIONS).take(count as usize), &CHIPS, || bar.advance(1))?;
    drop(bar);
    // Every violation, none hidden.
    cases.iter().filter(|case| case.is_violation()).for_each(|case| complain(format_args!("violation: {case:?}")));
    Ok(say(summary(&cases).markdown())?)
}
