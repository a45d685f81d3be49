//! The table of known answers, `reference/known_answers.csv`: the directions of the rods in exact
//! motions, with every digit proved.
//!
//! `cargo prove --known-answers` reproduces it digit for digit.

use std::str::FromStr;

use anyhow::Context;
use double_pendulum::Parameters;
use reference::taylor::{Reference, divide};
use reference::twofloat::TwoFloat;
use reference::twofloat::consts::PI;

/// A line of the table: a scene at one time.
#[derive(Clone, Debug)]
pub struct KnownAnswer {
    /// The scene's name.
    pub scene: &'static str,
    /// The scene's name, its given numbers and the time, as written in the file, with commas
    /// between them. Angles are in degrees, velocities in rad/s, all other numbers in SI units.
    pub given: &'static str,
    /// The scene at its start, time 0, in double-double precision. A clone of it advances to
    /// `time`.
    pub start: Reference,
    /// The masses (kg), lengths (m) and gravity (m/s^2), rounded to `f64`. The start is not
    /// rounded.
    pub parameters: Parameters<f64>,
    /// The time, s.
    pub time: f64,
    /// (sin a1, cos a1, sin a2, cos a2) at that time, as written.
    pub directions: [TwoFloat; 4],
    /// The largest error of the directions, each in turn: two units of the last digit written.
    pub radius: [f64; 4],
    /// About the factor by which a small error of the start has grown until that time. It is an
    /// estimate; nothing is proved about it.
    pub growth: f64,
}

/// The names of the columns, with commas between them and without a newline. The angles are in
/// degrees, the velocities in rad/s, all other numbers in SI units.
pub const HEADING: &str =
    "scene,a1_deg,a2_deg,w1_start,w2_start,m1,m2,l1,l2,g,t,sin_a1,cos_a1,sin_a2,cos_a2,growth";
/// The number of columns that contain the scene, its given numbers and the time.
const GIVEN: usize = 11;

/// Returns every line, in the file's order, without the heading. The file is compiled into the
/// program.
///
/// # Errors
/// The error contains the text of the first line that cannot be read. Not checked: the heading and
/// the range of the numbers.
pub fn table() -> anyhow::Result<Vec<KnownAnswer>> {
    let lines = include_str!("../../reference/known_answers.csv")
        .lines()
        .skip(1);
    lines
        .map(|line| {
            KnownAnswer::read(line)
                .with_context(|| format!("known_answers.csv: cannot read `{line}`"))
        })
        .collect()
}

impl KnownAnswer {
    fn read(line: &'static str) -> Option<Self> {
        // The text up to the time is kept as written.
        let (end, _) = line.match_indices(',').nth(GIVEN - 1)?;
        let (scene, numbers) = line.split_once(',')?;

        // The last digit of each number gives its error.
        let places = |text: &str| {
            text.split_once('.')
                .map_or(0, |(_, places)| places.len() as i32)
        };
        let radii: Vec<f64> = numbers
            .split(',')
            .map(|text| 2.0 * 10_f64.powi(-places(text)))
            .collect();

        let numbers: Vec<TwoFloat> = numbers.split(',').map(decimal).collect::<Option<_>>()?;
        let &[
            a1,
            a2,
            w1,
            w2,
            m1,
            m2,
            l1,
            l2,
            g,
            time,
            z1,
            z2,
            z3,
            z4,
            growth,
        ] = numbers.as_slice()
        else {
            return None;
        };

        // The start is in full precision, the other numbers are rounded.
        Some(Self {
            scene,
            given: &line[..end],
            start: Reference::exact(
                Parameters { m1, m2, l1, l2, g },
                [a1 * PI / 180.0, a2 * PI / 180.0, w1, w2],
            ),
            parameters: Parameters {
                m1: m1.into(),
                m2: m2.into(),
                l1: l1.into(),
                l2: l2.into(),
                g: g.into(),
            },
            time: time.into(),
            directions: [z1, z2, z3, z4],
            radius: radii[10..14].try_into().ok()?,
            growth: growth.into(),
        })
    }
}

/// Parses a decimal number in double-double precision: up to 38 digits, with or without a point and
/// an exponent.
fn decimal(text: &str) -> Option<TwoFloat> {
    // The digits without the point, and the power of ten.
    let (mantissa, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = i128::from_str(&format!("{whole}{fraction}")).ok()?;
    let exponent = i32::from_str(exponent).ok()? - i32::try_from(fraction.len()).ok()?;
    let power = TwoFloat::from(10.0).powi(exponent.abs());
    let digits = TwoFloat::from(digits);
    Some(if exponent < 0 {
        divide(digits, power)
    } else {
        digits * power
    })
}
