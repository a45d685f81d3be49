//! The command line of `cargo prove`.

use anyhow::{Context, ensure};
use clap::{Parser, value_parser};
use double_pendulum::Method;
use double_pendulum::plan::{Limit, Plan, Problem, Way};
use reference::enclosure::Start;

use crate::commands::plan;
use crate::console::cli::choice;

const EXAMPLES: &str = "Examples:
  cargo prove --scene page
  cargo prove --angles 120,120 --degrees --method rk4-f32-direction --steps 4

Ctrl-C leaves what is proved until then.";

/// Proves until when the frames that a chip draws are right to half a pixel: encloses the exact motion, rounding errors and
/// all, and holds each frame of the planned method, which is bit-identical on every chip, against it.
///
/// The motion is that of the decimals and fractions given; with --scene it is that of the board's own numbers.
#[derive(Debug, Parser)]
#[group(id = "prove")]
#[command(name = "cargo prove", after_help = EXAMPLES, mut_arg("study", |arg| arg.hide(true)), mut_arg("seed", |arg| arg.hide(true)))]
pub struct Options {
    /// What moves, and who draws it.
    #[command(flatten)]
    pub plan: plan::Options,
    /// Draws by this method in place of the planned one
    #[arg(long, value_name = "NAME", value_parser = choice(Method::DRAWN.iter().copied(), Method::name))]
    method: Option<Method>,
    /// Its steps to a frame
    #[arg(long, value_name = "N", requires = "method", default_value_t = 1, value_parser = value_parser!(u32).range(1..=65_536))]
    steps: u32,
    /// Prints the box that the exact motion is in at each frame, and the frame's verdict, as CSV
    #[arg(long)]
    pub csv: bool,
    /// Prints the horizons of all scenes on all chips, predicted and proved, as a table
    #[arg(long, conflicts_with_all = ["scene", "method", "csv"])]
    pub table: bool,
    /// Prints the table of known answers in host-tests/data anew, every digit of it proved
    #[arg(long, conflicts_with_all = ["scene", "method", "csv", "table"])]
    pub known_answers: bool,
}

impl Options {
    /// What moves, its start to the last digit, and the plan, or what forbids any.
    pub fn scene(&self) -> anyhow::Result<(Problem, Start, Result<Plan, Limit>)> {
        ensure!(self.plan.study.is_none(), "--study: is an option of cargo plan");
        let (scene, plan) = self.plan.plan()?;
        let start = match self.plan.scene {
            Some(_) => Start::of(&scene.pendulum, &scene.start),
            None => self.plan.start.exact().context("of a number, 18 digits at most can be enclosed")?,
        };
        Ok((scene, start, plan))
    }

    /// How the frames are drawn, if anything holds.
    pub fn way(&self, plan: &Result<Plan, Limit>) -> Option<Way> {
        let planned = || plan.as_ref().ok().map(|plan| Way { method: plan.method, steps: plan.steps.max(1) });
        self.method.map(|method| Way { method, steps: self.steps }).or_else(planned)
    }
}
