//! The table of known answers, `data/known_answers.csv`: exact motions, every digit proved.
//!
//! `cargo prove --known-answers` makes it again, digit for digit.

use std::str::FromStr;

use double_pendulum::{Bounds, Motion, Parameters, Pendulum, State};
use twofloat::TwoFloat;
use twofloat::consts::PI;

use crate::oracle::reference::series::divide;
use crate::oracle::reference::{Constants, Reference};

/// One line of the table: a scene at one time.
#[derive(Clone, Debug)]
pub struct KnownAnswer {
    /// The scene's name.
    pub scene: &'static str,
    /// Masses (kg), lengths (m), gravity (m/s^2).
    pub constants: Constants,
    /// The angles at the start, rad.
    pub start_angles: [TwoFloat; 2],
    /// The angular velocities at the start, rad/s.
    pub start_velocities: [TwoFloat; 2],
    /// The time, s.
    pub time: f64,
    /// (a1, a2, p1, p2) at that time, rad and kg m^2/s.
    pub state: [TwoFloat; 4],
    /// What these may be off by: two units of the last digit written.
    pub radius: [f64; 4],
    /// How many times larger a small error of the start has become by then.
    pub growth: f64,
}

/// Every line, in the file's order.
///
/// # Errors
/// Names the first line that cannot be read.
pub fn table() -> Result<Vec<KnownAnswer>, String> {
    let lines = include_str!("../../data/known_answers.csv").lines().skip(1);
    lines
        .map(|line| KnownAnswer::read(line).ok_or_else(|| format!("known_answers.csv: cannot read `{line}`")))
        .collect()
}

impl KnownAnswer {
    fn read(line: &'static str) -> Option<Self> {
        let (scene, numbers) = line.split_once(',')?;
        let places = |text: &str| text.split_once('.').map_or(0, |(_, places)| places.len() as i32);
        let radii: Vec<f64> = numbers.split(',').map(|text| 2.0 * 10_f64.powi(-places(text))).collect();
        let numbers: Vec<TwoFloat> = numbers.split(',').map(decimal).collect::<Option<_>>()?;
        let &[a1, a2, w1, w2, m1, m2, l1, l2, gravity, time, z1, z2, z3, z4, growth] = numbers.as_slice() else {
            return None;
        };
        Some(Self {
            scene,
            constants: Constants { masses: [m1, m2], lengths: [l1, l2], gravity },
            start_angles: [a1, a2].map(|degrees| degrees * PI / 180.0),
            start_velocities: [w1, w2],
            time: time.into(),
            state: [z1, z2, z3, z4],
            radius: radii[10..14].try_into().ok()?,
            growth: growth.into(),
        })
    }

    /// The scene at its start, in full precision.
    pub fn reference(&self) -> Reference {
        Reference::exact(self.constants, self.start_angles, self.start_velocities)
    }

    /// The parameters, rounded to f64.
    pub fn parameters(&self) -> Parameters<f64> {
        let Constants { masses: [m1, m2], lengths: [l1, l2], gravity } = self.constants;
        Parameters { m1: m1.into(), m2: m2.into(), l1: l1.into(), l2: l2.into(), g: gravity.into() }
    }

    /// The start, rounded to f64.
    pub fn start(&self) -> Motion<f64> {
        let ([a1, a2], [w1, w2]) = (self.start_angles, self.start_velocities);
        Motion { a1: a1.into(), a2: a2.into(), w1: w1.into(), w2: w2.into() }
    }

    /// The fastest rate in the motion, 1/s: the fast normal frequency or the greatest angular velocity.
    pub fn fastest_rate(&self) -> f64 {
        let Ok(pendulum) = Pendulum::<f64>::new(&self.parameters()) else { return f64::NAN };
        let Bounds { w1, w2, .. } = pendulum.bounds(&pendulum.to_state(&self.start()));
        pendulum.modes().map_or(0.0, |modes| modes.fast.frequency).max(w1).max(w2)
    }

    /// The answer, rounded to f64.
    pub fn answer(&self) -> State<f64> {
        self.state.map(f64::from).into()
    }
}

/// A decimal number in double-double precision: up to 38 digits, with or without a point and an exponent.
fn decimal(text: &str) -> Option<TwoFloat> {
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = i128::from_str(&format!("{whole}{fraction}")).ok()?;
    let exponent = i32::from_str(exponent).ok()? - i32::try_from(fraction.len()).ok()?;
    let power = TwoFloat::from(10.0).powi(exponent.abs());
    let digits = TwoFloat::from(digits);
    Some(if exponent < 0 { divide(digits, power) } else { digits * power })
}
