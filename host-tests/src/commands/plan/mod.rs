//! `cargo plan`: how to compute a scene as cheaply as may be; and the planner held against the reference.

mod options;
mod study;
mod words;

pub use options::{CHIPS, Chip, M3, M4F, PICO, SceneOptions};
pub use study::{Case, DURATIONS, median, scenes, study};

use clap::Parser;

use crate::console::cli::{Refused, say};

const EXAMPLES: &str = "Examples:
  cargo plan --angles 90,90 --degrees --height 64 --duration 10
  cargo plan --masses 1,2.75 --angles 171,171 --degrees --target m4f
  cargo plan --scene figure-7 --target pico";

/// Says how to compute a motion as cheaply as may be, right to half a pixel about the exact one, and until when that is
/// expected; or that nothing the chip can afford is right in any frame, which is an answer, too (exit code 0).
///
/// Numbers are decimals (0.25, 1e-3) or fractions (1/256).
#[derive(Debug, Parser)]
#[command(name = "cargo plan", after_help = EXAMPLES)]
pub struct PlanOptions {
    /// What moves.
    #[command(flatten)]
    scene: SceneOptions,
}

pub fn run(PlanOptions { scene }: &PlanOptions) -> anyhow::Result<()> {
    let (problem, plan) = scene.plan().map_err(Refused::because)?;
    Ok(words::words(&problem, &plan, &scene.target).iter().try_for_each(say)?)
}
