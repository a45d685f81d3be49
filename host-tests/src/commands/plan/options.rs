//! The command line of `cargo plan`.

use anyhow::{anyhow, ensure};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, value_parser};
use double_pendulum::plan::{Limit, Plan, PlanError, Problem, Quantity};
use double_pendulum::{Motion, Parameter};
use firmware::motion::planner::half_pixel;

use super::target::{CHIPS, Chip};
use crate::commands::simulate::{Number, Start};

const EXAMPLES: &str = "Examples:
  cargo plan --angles 90,90 --degrees --height 64 --duration 10
  cargo plan --masses 1,2.75 --angles 171,171 --degrees --target m4f
  cargo plan --study 100";

/// Says how to compute a scene as cheaply as may be, right to half a pixel about the exact motion, and until when it is; or
/// that nothing the chip can afford is right in any frame, which is an answer, too (exit code 0).
///
/// Numbers are decimals (0.25, 1e-3) or fractions (1/256).
#[derive(Debug, Parser)]
#[command(name = "cargo plan", after_help = EXAMPLES)]
pub struct Options {
    /// What moves.
    #[command(flatten)]
    pub start: Start,
    /// Height of the display, pixels; both rods together are half of it long
    #[arg(long, value_name = "PIXELS", default_value = "64", allow_hyphen_values = true)]
    pub height: Number,
    /// How long the scene lasts, s
    #[arg(long, value_name = "T", default_value = "30", allow_hyphen_values = true)]
    pub duration: Number,
    /// Frames per second, 1 to 65535
    #[arg(long, value_name = "N", default_value = "60", allow_hyphen_values = true)]
    pub rate: Number,
    /// The chip that computes it
    #[arg(long, value_name = "CHIP", default_value = CHIPS[0].name,
          value_parser = PossibleValuesParser::new(CHIPS.iter().map(|chip| chip.name)).map(|name| chip(&name)))]
    pub target: Chip,
    /// Plan this many scenes of all kinds instead, carry them out beside the reference, and print what came of it
    #[arg(long, value_name = "SCENES", value_parser = value_parser!(u32).range(1..))]
    pub study: Option<u32>,
    /// Hold the planner's margins against the exact motion of this many scenes instead
    #[arg(long, value_name = "SCENES", conflicts_with = "study", value_parser = value_parser!(u32).range(1..))]
    pub fit: Option<u32>,
    /// Which scenes
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = value_parser!(u32).range(0..))]
    pub seed: u32,
}

fn chip(name: &str) -> Chip {
    CHIPS.into_iter().find(|chip| chip.name == name).unwrap_or(CHIPS[0])
}

impl Options {
    /// The scene with its plan, or with what forbids any; an error is one line that names the option and the value.
    pub fn plan(&self) -> anyhow::Result<(Problem, Result<Plan, Limit>)> {
        let rate = &self.rate;
        let whole = rate.value().fract() == 0.0 && rate.is_positive();
        ensure!(whole, "--rate {rate}: must be a whole number of frames per second, at least 1");
        ensure!(rate.value() <= f64::from(u16::MAX), "--rate {rate}: more than {}", u16::MAX);
        ensure!(self.height.is_positive(), "--height {}: must be greater than zero", self.height);
        let ([a1, a2], [w1, w2]) = (self.start.angles(), self.start.velocities());
        let scene = Problem {
            pendulum: self.start.parameters(),
            start: Motion { a1, a2, w1, w2 },
            tolerance: half_pixel(&self.start.parameters(), self.height.value()),
            duration: self.duration.value(),
            rate: rate.value() as u16,
        };
        let plan = self.target.plan(&scene);
        Ok((scene, plan.map_err(|error| anyhow!("{}: {error}", option_of(&error)))?))
    }
}

/// The option that sets what is refused.
fn option_of(error: &PlanError) -> &'static str {
    match error {
        PlanError::Motion(error) => match error.parameter() {
            Parameter::M1 | Parameter::M2 | Parameter::Mu => "--masses",
            Parameter::L1 | Parameter::L2 => "--lengths",
            Parameter::G => "--gravity",
            Parameter::A1 | Parameter::A2 => "--angles",
            Parameter::W1 | Parameter::W2 | Parameter::P1 | Parameter::P2 => "--velocities",
            _ => "the scene",
        },
        PlanError::NotPositive { quantity, .. } | PlanError::TooLarge { quantity, .. } => match quantity {
            Quantity::Tolerance => "--height",
            Quantity::Duration => "--duration",
            Quantity::Rate => "--rate",
            _ => "the scene",
        },
        _ => "the scene",
    }
}
