//! The command line of `cargo simulate`, and the start that other commands take, too.

use std::f64::consts::TAU;
use std::path::PathBuf;

use clap::{ArgAction, Args, Parser};
use double_pendulum::{Error, Method, Motion, Parameters, radians};
use exact::enclosure::Start as Exact;
use exact::taylor::Reference;
use firmware::config::{FIRST_ANGLE, GRAVITY};
use firmware::motion::Settings;
use firmware::scenes::SceneName;

use super::NAMES;
use boards::console::cli::{choice, choice_with_aliases, option_of};
use boards::console::number::{Number, Pair};
use boards::{BOARDS, Board};

/// The emulated board that computes the motion, or `None` for this program.
pub type Place = Option<&'static Board>;

const HOST: &str = "host";

pub(super) fn name(place: Place) -> &'static str {
    names(place)[0]
}

fn names(place: Place) -> Vec<&'static str> {
    place.map_or_else(|| vec![HOST], Board::names)
}

const AFTER_HELP: &str = "\
Examples:
  cargo simulate --angles 120,120 --degrees --seconds 5 --every 0.1 --out swing.csv
  cargo simulate --angles 120,120 --degrees --seconds 5 --tolerance 1e-9
  cargo simulate --scene butterfly --every 1
  cargo simulate --angles 0.5,0.5 --step 1/256 --method rk4-fixed32 --board pico --bits
  cargo simulate --angles 0.5,0.5 --step 1/16 --columns t,x2,y2 --header units
  cargo simulate --list

A second run shows until when the rows hold: a note on stderr, and the last line of the file.

Exit code 2: bad input. Exit code 1: the motion diverges, or the tolerance is kept for a part of the
time only; the rows until then are printed. Both with one line on stderr.";

/// Computes a motion of the double pendulum and prints it as CSV in SI units. Numbers are decimals
/// (0.25, 1e-3) or fractions (1/256).
#[derive(Debug, Parser)]
#[command(name = "cargo simulate", after_help = AFTER_HELP)]
pub struct SimulateOptions {
    /// What moves.
    #[command(flatten)]
    pub start: StartOptions,
    /// A built-in scene, as the boards start it
    #[arg(
        long,
        value_name = "NAME",
        value_parser = choice(SceneName::ALL.iter().copied(), SceneName::name),
        hide_possible_values = true,
        conflicts_with_all = ["masses", "lengths", "gravity", "angles", "velocities", "degrees"],
    )]
    pub scene: Option<SceneName>,
    /// Longest step, s; shortened to divide the time between rows [default: at most 1/1024 s, and
    /// safe for the fastest motion possible at this energy]
    #[arg(long, value_name = "DT", allow_hyphen_values = true)]
    pub step: Option<Number>,
    /// Largest error allowed in any angle, rad; finds and uses the cheapest method and step that
    /// meet it
    #[arg(
        long,
        value_name = "E",
        conflicts_with = "step",
        allow_hyphen_values = true
    )]
    pub tolerance: Option<Number>,
    /// Time of the motion, s
    #[arg(
        long,
        alias = "until",
        alias = "duration",
        value_name = "N",
        default_value = "10",
        allow_hyphen_values = true
    )]
    pub seconds: Number,
    /// Time from row to row, s [default: one --step; without --step a hundredth of --seconds]
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub every: Option<Number>,
    /// The method, one of --list [default: rk4-f64]
    #[arg(
        long,
        value_name = "NAME",
        value_parser = choice(Method::ALL.iter().copied(), Method::name),
        hide_possible_values = true,
    )]
    pub method: Option<Method>,
    /// Print the table of methods: name, equations, numbers, integrator, order, where it runs
    #[arg(long, exclusive = true)]
    pub list: bool,
    /// Where to compute it: on this computer, or in the firmware on an emulated board; `pico` is
    /// lm3s6965evb-m0, which has its core
    #[arg(long = "board", alias = "on", alias = "target", value_name = "NAME", default_value = HOST,
          value_parser = choice_with_aliases([None].into_iter().chain(BOARDS.iter().map(Some)), names))]
    pub place: Place,
    /// The columns: any of t, a1, a2, p1, p2, w1, w2, energy, and the bobs' positions x1, y1, x2,
    /// y2 from the pivot, y upwards
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "t,a1,a2,p1,p2,w1,w2,energy",
        value_parser = choice(0..NAMES.len(), |column| NAMES[column]),
        hide_possible_values = true,
    )]
    pub columns: Vec<usize>,
    /// The first line: the names of the columns, or names with units
    #[arg(long = "header", value_name = "KIND", default_value = "names", action = ArgAction::Set,
          value_parser = choice([false, true], |units| if units { "units" } else { "names" }))]
    pub units: bool,
    /// Add the bit patterns of a1, a2, p1, p2 in hexadecimal
    #[arg(long)]
    pub bits: bool,
    /// Write the table to this file instead of the terminal
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

impl SimulateOptions {
    fn start(&self) -> StartOptions {
        self.scene.map_or_else(
            || self.start.clone(),
            |scene| StartOptions::of(&scene.first_settings()),
        )
    }

    pub fn motion(&self) -> (Parameters<f64>, Motion<f64>) {
        let start = self.start();
        (start.parameters(), start.motion())
    }

    /// Returns the exact motion, from exactly the given decimals if they are not too long.
    pub fn reference(&self) -> Reference {
        let start = self.start();
        let rounded = || Exact::of(&start.parameters(), &start.motion());
        Reference::of(&start.exact().unwrap_or_else(rounded))
    }
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
          help = format!("Angles at the start from hanging, rad (see --degrees) [default: \
                          {FIRST_ANGLE} degrees both]"))]
    angles: Option<Pair>,
    /// Angular velocities at the start, rad/s (see --degrees)
    #[arg(
        long,
        value_name = "W1,W2",
        default_value = "0,0",
        allow_hyphen_values = true
    )]
    pub velocities: Pair,
    /// Read angles in degrees and velocities in degrees per second; results are printed in radians
    #[arg(long)]
    degrees: bool,
}

fn number(value: f64) -> Number {
    value.to_string().parse().expect("a decimal")
}

impl StartOptions {
    pub fn of(settings: &Settings) -> Self {
        let Parameters { m1, m2, l1, l2, g } = settings.parameters;
        let pair = |[one, other]: [f64; 2]| Pair(number(one), number(other));
        Self {
            masses: pair([m1, m2]),
            lengths: pair([l1, l2]),
            gravity: Some(number(g)),
            angles: Some(pair(settings.degrees)),
            velocities: pair(settings.velocities.map(f64::to_degrees)),
            degrees: true,
        }
    }

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
        let in_radians = |angle: f64| {
            if self.degrees { radians(angle) } else { angle }
        };
        let first = [radians(FIRST_ANGLE); 2];
        let [a1, a2] = self
            .angles
            .as_ref()
            .map_or(first, |angles| angles.values().map(in_radians));
        let [w1, w2] = self.velocities.values().map(in_radians);
        Motion { a1, a2, w1, w2 }
    }

    /// Returns a line of advice if an angle is more than a turn to either side and may be meant in
    /// degrees.
    pub fn advice(&self) -> Option<String> {
        let angles = self.angles.as_ref().filter(|_| !self.degrees)?;
        let largest = [&angles.0, &angles.1]
            .into_iter()
            .max_by(|one, other| one.value().abs().total_cmp(&other.value().abs()))?;
        let turns = largest.value().abs() / TAU;
        (turns > 1.0).then(|| {
            format!(
                "note: --angles {angles}: {largest} rad is {turns:.1} turns; for degrees add \
                     --degrees"
            )
        })
    }

    pub fn refusal(&self, error: &Error, otherwise: &'static str) -> String {
        format!("{}: {error}", option_of(error, otherwise))
    }

    /// Returns the first option whose number has too many digits for [`Self::exact`].
    pub fn too_long(&self) -> String {
        let pairs = [
            ("--masses", Some(&self.masses)),
            ("--lengths", Some(&self.lengths)),
            ("--angles", self.angles.as_ref()),
            ("--velocities", Some(&self.velocities)),
        ];
        let is_long = |pair: &&Pair| pair.0.exact().is_none() || pair.1.exact().is_none();
        let found = pairs
            .into_iter()
            .find_map(|(option, pair)| Some(format!("{option} {}", pair.filter(is_long)?)));
        let gravity = self.gravity.as_ref();
        let gravity = gravity.map(|gravity| format!("--gravity {gravity}"));
        found.or(gravity).unwrap_or_default()
    }

    /// Returns the pendulum and its start with all given digits, or `None` if a number has too
    /// many. Default angles are in degrees.
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
