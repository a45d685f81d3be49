//! The command line of `cargo simulate`.

use clap::{ArgAction, Args, Parser};
use double_pendulum::{Error, Method, Motion, Parameter, Parameters};
use firmware::config::{FIRST_ANGLE, GRAVITY};
use reference::enclosure::Start as Exact;

use super::NAMES;
use super::number::{Number, Pair};
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
    #[arg(
        long,
        value_name = "DT",
        default_value = "1/1024",
        allow_hyphen_values = true
    )]
    pub step: Number,
    /// Instead of a step: the error, rad, that no angle of any row may exceed; the cheapest method and step that keep it,
    /// by the reference, are found and taken
    #[arg(
        long,
        value_name = "E",
        conflicts_with = "step",
        allow_hyphen_values = true
    )]
    pub tolerance: Option<Number>,
    /// Time of the last row, s
    #[arg(
        long,
        value_name = "T",
        default_value = "10",
        allow_hyphen_values = true
    )]
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
          value_parser = choice(0..NAMES.len(), |column| NAMES[column]), hide_possible_values = true)]
    pub columns: Vec<usize>,
    /// What the first line says: the names of the columns, or their units as well
    #[arg(long = "header", value_name = "KIND", default_value = "names", action = ArgAction::Set,
          value_parser = choice([false, true], |units| if units { "units" } else { "names" }))]
    pub units: bool,
    /// Add the bit patterns of a1, a2, p1, p2 in hexadecimal
    #[arg(long)]
    pub bits: bool,
}

/// A pendulum and its start.
#[derive(Args, Clone, Debug)]
pub struct StartOptions {
    /// Masses of the bobs, kg
    #[arg(
        long,
        value_name = "M1,M2",
        default_value = "1,1",
        allow_hyphen_values = true
    )]
    masses: Pair,
    /// Lengths of the rods, m
    #[arg(
        long,
        value_name = "L1,L2",
        default_value = "1,1",
        allow_hyphen_values = true
    )]
    lengths: Pair,
    #[arg(long, value_name = "G", allow_hyphen_values = true,
          help = format!("Gravitational acceleration, m/s^2 [default: {GRAVITY}]"))]
    gravity: Option<Number>,
    #[arg(long, value_name = "A1,A2", allow_hyphen_values = true,
          help = format!("Angles at the start from hanging, rad (see --degrees) [default: {FIRST_ANGLE} degrees both]"))]
    angles: Option<Pair>,
    /// Angular velocities at the start, rad/s (see --degrees)
    #[arg(
        long,
        value_name = "W1,W2",
        default_value = "0,0",
        allow_hyphen_values = true
    )]
    pub velocities: Pair,
    /// Read angles in degrees and velocities in degrees per second; what is printed stays in radians
    #[arg(long)]
    degrees: bool,
}

impl StartOptions {
    pub fn parameters(&self) -> Parameters<f64> {
        let [[m1, m2], [l1, l2]] = [&self.masses, &self.lengths].map(Pair::values);
        Parameters {
            m1,
            m2,
            l1,
            l2,
            g: self.gravity.as_ref().map_or(GRAVITY, Number::value),
        }
    }

    pub fn motion(&self) -> Motion<f64> {
        let radians = |angle: f64| {
            if self.degrees {
                angle.to_radians()
            } else {
                angle
            }
        };
        let first = [f64::from(FIRST_ANGLE).to_radians(); 2];
        let [a1, a2] = self
            .angles
            .as_ref()
            .map_or(first, |angles| angles.values().map(radians));
        let [w1, w2] = self.velocities.values().map(radians);
        Motion { a1, a2, w1, w2 }
    }

    /// All of it to the last digit given; `None` if a number has too many.
    pub fn exact(&self) -> Option<Exact> {
        let [gravity, first] =
            [GRAVITY.to_string(), FIRST_ANGLE.to_string()].map(|text| text.parse::<Number>().ok());
        let first = first?;
        let angles = self.angles.clone().unwrap_or(Pair(first.clone(), first));
        let degrees = [self.degrees || self.angles.is_none(), self.degrees];
        let [m, l, a, w] = [&self.masses, &self.lengths, &angles, &self.velocities];
        let numbers = [
            &a.0,
            &a.1,
            &w.0,
            &w.1,
            &m.0,
            &m.1,
            &l.0,
            &l.1,
            self.gravity.as_ref().or(gravity.as_ref())?,
        ];
        let fractions = numbers
            .into_iter()
            .map(Number::exact)
            .collect::<Option<Vec<_>>>()?
            .try_into()
            .ok()?;
        Some(Exact {
            about: (self.parameters(), self.motion()),
            fractions: Some(fractions),
            degrees,
        })
    }
}

/// The option that sets what is refused, if it is of this pendulum or how it is shown.
pub fn option_of(error: &Error, otherwise: &'static str) -> &'static str {
    match error.parameter() {
        _ if matches!(error, Error::Diverged { .. }) => otherwise,
        Parameter::M1 | Parameter::M2 => "--masses",
        Parameter::L1 | Parameter::L2 => "--lengths",
        Parameter::G => "--gravity",
        Parameter::A1 | Parameter::A2 => "--angles",
        Parameter::W1 | Parameter::W2 | Parameter::P1 | Parameter::P2 => "--velocities",
        Parameter::Tolerance => "--height",
        Parameter::Duration => "--duration",
        Parameter::Rate => "--rate",
        _ => otherwise,
    }
}
