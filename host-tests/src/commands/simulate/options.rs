//! The command line of `cargo simulate`.

use clap::Parser;
use firmware::job::{Arithmetic, Formulation, Integrator, Model, Wanted};

use super::{Number, Start};
use crate::console::cli::choice;
use crate::emulator::boards::{BOARDS, Board};

/// Where the motion is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// By this program.
    Host,
    /// By the firmware on an emulated board.
    Board(&'static Board),
}

impl Place {
    const HOST: &str = "host";

    fn all() -> impl Iterator<Item = Self> {
        std::iter::once(Self::Host).chain(BOARDS.iter().map(Self::Board))
    }

    fn name(self) -> &'static str {
        match self {
            Self::Host => Self::HOST,
            Self::Board(board) => board.name,
        }
    }
}

const AFTER_HELP: &str = "\
Examples:
  cargo simulate --angles 120,120 --degrees --until 5 --tolerance 1e-9
  cargo simulate --angles 0.5,0.5 --until 10 --every 1/10 --tolerance 1e-5 --on lm3s6965evb
  cargo simulate --angles 171,171 --degrees --masses 1,2.75 --step 1/4096 --until 5 --every 1
  cargo simulate --angles 0.5,0.5 --step 1/256 --arithmetic f32-compensated --on lm3s6965evb
  cargo simulate --angles 0.5,0.5 --step 1/256 --arithmetic fixed32 --on lm3s6965evb --bits
  cargo simulate --angles 0.5,0.5 --step 1/16 --arithmetic fixed64 --integrator extrapolation --order 12

Bad input, and numbers with which not even one step can be made: one line on stderr, exit code 2. A motion that leaves
the finite numbers later: its rows until then, one line on stderr, exit code 1.";

/// Computes a motion of the double pendulum and prints it as CSV: t,a1,a2,p1,p2,w1,w2,energy in SI units.
///
/// Numbers are decimals (0.25, 1e-3) or fractions (1/256).
#[derive(Debug, Parser)]
#[command(name = "cargo simulate", after_help = AFTER_HELP)]
pub struct Options {
    /// What moves.
    #[command(flatten)]
    pub start: Start,
    /// Step size, s; a warning says when it is too long to resolve every motion of this energy
    #[arg(long, value_name = "DT", default_value = "1/1024", allow_hyphen_values = true)]
    pub step: Number,
    /// Instead of a step: the error, rad, that no angle of any row may exceed; the cheapest arithmetic, method and step that
    /// keep it, by the reference, are found and taken, among those that other options leave
    #[arg(long, value_name = "E", conflicts_with = "step", allow_hyphen_values = true)]
    pub tolerance: Option<Number>,
    /// Time of the last row, s
    #[arg(long, value_name = "T", default_value = "10", allow_hyphen_values = true)]
    pub until: Number,
    /// Time from row to row, s; if not given one step, with --tolerance a hundredth of --until
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub every: Option<Number>,
    /// The numbers it is computed in; if not given, f64, f64-libm for textbook, fixed64 for extrapolation
    #[arg(long, value_name = "NAME", value_parser = choice(Arithmetic::ALL.iter().copied(), Arithmetic::name))]
    pub arithmetic: Option<Arithmetic>,
    /// The equations of motion; general if not given
    #[arg(long, value_name = "NAME", value_parser = choice(Model::ALL.iter().copied(), Model::name))]
    pub model: Option<Model>,
    /// The quantities stepped; if not given, the first that goes with the rest
    #[arg(long, value_name = "NAME", value_parser = choice(Formulation::ALL.iter().copied(), Formulation::name))]
    pub form: Option<Formulation>,
    /// How a step is made; in double precision and fixed64 extrapolation for errors of 1e-9 rad and less
    #[arg(long, visible_alias = "method", value_name = "NAME", value_parser = choice(Integrator::ALL.iter().copied(), Integrator::name))]
    pub integrator: Option<Integrator>,
    /// The order of the integrator
    #[arg(long, value_name = "N")]
    pub order: Option<u8>,
    /// Where it is computed: here, or by the firmware on an emulated board
    #[arg(long = "on", value_name = "PLACE", default_value = Place::HOST,
          value_parser = choice(Place::all(), Place::name))]
    pub place: Place,
    /// Add the bit patterns of a1, a2, p1, p2 in hexadecimal
    #[arg(long)]
    pub bits: bool,
}

impl Options {
    /// What they ask of a row of the table.
    pub fn wanted(&self) -> Wanted {
        let Self { arithmetic, model, form, integrator, order, .. } = *self;
        Wanted { arithmetic, model, form, integrator, order }
    }
}
