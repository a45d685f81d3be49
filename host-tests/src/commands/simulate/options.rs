//! The command line of `cargo simulate`.

use clap::{ArgAction, Parser};
use double_pendulum::Method;

use super::table::{COLUMNS, Column};
use super::{Number, StartOptions};
use crate::console::cli::choice;
use crate::emulator::boards::{BOARDS, Board};

/// Where the motion is computed: by the firmware on an emulated board, or by this program.
pub type Place = Option<&'static Board>;

const HOST: &str = "host";

pub(super) fn name(place: Place) -> &'static str {
    place.map_or(HOST, |board| board.name)
}

const AFTER_HELP: &str = "\
Examples:
  cargo simulate --angles 120,120 --degrees --until 5 --tolerance 1e-9
  cargo simulate --angles 0.5,0.5 --until 10 --every 1/10 --tolerance 1e-5 --on lm3s6965evb
  cargo simulate --angles 171,171 --degrees --masses 1,2.75 --step 1/4096 --until 5 --every 1
  cargo simulate --angles 0.5,0.5 --step 1/256 --method rk4-fixed32 --on lm3s6965evb --bits
  cargo simulate --angles 0.5,0.5 --step 1/16 --method extrapolation12-f64 --columns t,x2,y2 --header units
  cargo simulate --list

Bad input, and numbers with which not even one step can be made: one line on stderr, exit code 2. A motion that leaves
the finite numbers later: its rows until then, one line on stderr, exit code 1.";

/// Computes a motion of the double pendulum and prints it as CSV, SI units. Numbers are decimals (0.25, 1e-3) or fractions (1/256).
#[derive(Debug, Parser)]
#[command(name = "cargo simulate", after_help = AFTER_HELP)]
pub struct SimulateOptions {
    /// What moves.
    #[command(flatten)]
    pub start: StartOptions,
    /// Step size, s; a warning says when it is too long to resolve every motion of this energy
    #[arg(long, value_name = "DT", default_value = "1/1024", allow_hyphen_values = true)]
    pub step: Number,
    /// Instead of a step: the error, rad, that no angle of any row may exceed; the cheapest method and step that keep it,
    /// by the reference, are found and taken
    #[arg(long, value_name = "E", conflicts_with = "step", allow_hyphen_values = true)]
    pub tolerance: Option<Number>,
    /// Time of the last row, s
    #[arg(long, value_name = "T", default_value = "10", allow_hyphen_values = true)]
    pub until: Number,
    /// Time from row to row, s; if not given one step, with --tolerance a hundredth of --until
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub every: Option<Number>,
    /// Equations, numbers, integrator and its order, by a name of --list; rk4-f64 if not given
    #[arg(long, value_name = "NAME", value_parser = choice(Method::ALL.iter().copied(), Method::name), hide_possible_values = true)]
    pub method: Option<Method>,
    /// Print the table of methods: name, equations, numbers, integrator, order, where it runs
    #[arg(long, exclusive = true)]
    pub list: bool,
    /// Where it is computed: here, or by the firmware on an emulated board
    #[arg(long = "on", value_name = "PLACE", default_value = HOST,
          value_parser = choice([None].into_iter().chain(BOARDS.iter().map(Some)), name))]
    pub place: Place,
    /// The columns, of t, a1, a2, p1, p2, w1, w2, energy, and x1, y1, x2, y2 of the bobs from the pivot, y upwards
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "t,a1,a2,p1,p2,w1,w2,energy",
          value_parser = choice(COLUMNS, |(name, ..)| name), hide_possible_values = true)]
    pub columns: Vec<Column>,
    /// What the first line says: the names of the columns, or their units as well
    #[arg(long = "header", value_name = "KIND", default_value = "names", action = ArgAction::Set,
          value_parser = choice([false, true], |units| if units { "units" } else { "names" }))]
    pub units: bool,
    /// Add the bit patterns of a1, a2, p1, p2 in hexadecimal
    #[arg(long)]
    pub bits: bool,
}
