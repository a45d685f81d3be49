//! The options that say what moves: the pendulum and how it starts.

use std::f64::consts::PI;
use std::fmt;

use clap::Args;
use double_pendulum::{Error, Motion, Parameter, Parameters};
use firmware::config::{FIRST_ANGLE, GRAVITY};

use super::Number;
use reference::enclosure::Start as Exact;

/// A degree, rad.
const DEGREE: f64 = PI / 180.0;

/// Two numbers separated by a comma: one for each bob or rod.
#[derive(Clone, Debug)]
pub struct Pair(Number, Number);

impl Pair {
    /// Their nearest `f64`.
    pub fn values(&self) -> [f64; 2] {
        [self.0.value(), self.1.value()]
    }
}

impl fmt::Display for Pair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.0, self.1)
    }
}

impl std::str::FromStr for Pair {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (first, second) = text.split_once(',').ok_or("write two numbers with a comma between them")?;
        let number = |text: &str| text.trim().parse().map_err(|error| format!("'{text}': {error}"));
        Ok(Pair(number(first)?, number(second)?))
    }
}

/// A pendulum and its start.
#[derive(Args, Clone, Debug)]
pub struct StartOptions {
    /// Masses of the bobs, kg
    #[arg(long, value_name = "M1,M2", default_value = "1,1", allow_hyphen_values = true)]
    masses: Pair,
    /// Lengths of the rods, m
    #[arg(long, value_name = "L1,L2", default_value = "1,1", allow_hyphen_values = true)]
    lengths: Pair,
    #[arg(long, value_name = "G", allow_hyphen_values = true,
          help = format!("Gravitational acceleration, m/s^2 [default: {GRAVITY}]"))]
    gravity: Option<Number>,
    #[arg(long, value_name = "A1,A2", allow_hyphen_values = true,
          help = format!("Angles at the start from hanging, rad (see --degrees) [default: {FIRST_ANGLE} degrees both]"))]
    angles: Option<Pair>,
    /// Angular velocities at the start, rad/s (see --degrees)
    #[arg(long, value_name = "W1,W2", default_value = "0,0", allow_hyphen_values = true)]
    pub velocities: Pair,
    /// Read angles in degrees and velocities in degrees per second; what is printed stays in radians
    #[arg(long)]
    degrees: bool,
}

impl StartOptions {
    pub fn parameters(&self) -> Parameters<f64> {
        let [[m1, m2], [l1, l2]] = [&self.masses, &self.lengths].map(Pair::values);
        Parameters { m1, m2, l1, l2, g: self.gravity.as_ref().map_or(GRAVITY, Number::value) }
    }

    pub fn motion(&self) -> Motion<f64> {
        let radians = |angle| if self.degrees { angle * DEGREE } else { angle };
        let first = [f64::from(FIRST_ANGLE) * DEGREE; 2];
        let [a1, a2] = self.angles.as_ref().map_or(first, |angles| angles.values().map(radians));
        let [w1, w2] = self.velocities.values().map(radians);
        Motion { a1, a2, w1, w2 }
    }

    /// All of it to the last digit given; `None` if a number has too many.
    pub fn exact(&self) -> Option<Exact> {
        let [gravity, first] = [GRAVITY.to_string(), FIRST_ANGLE.to_string()].map(|text| text.parse::<Number>().ok());
        let first = first?;
        let angles = self.angles.clone().unwrap_or(Pair(first.clone(), first));
        let degrees = [self.degrees || self.angles.is_none(), self.degrees];
        let [m, l, a, w] = [&self.masses, &self.lengths, &angles, &self.velocities];
        let numbers = [&a.0, &a.1, &w.0, &w.1, &m.0, &m.1, &l.0, &l.1, self.gravity.as_ref().or(gravity.as_ref())?];
        let fractions = numbers.into_iter().map(Number::exact).collect::<Option<Vec<_>>>()?.try_into().ok()?;
        Some(Exact { about: (self.parameters(), self.motion()), fractions: Some(fractions), degrees })
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
