//! The table of known answers, `exact/known_answers.csv`: the directions of the rods in exact
//! motions, with every digit proved.
//!
//! `cargo prove --known-answers` reproduces it digit for digit.

use std::str::FromStr;

use crate::taylor::{Reference, divide};
use crate::twofloat::TwoFloat;
use crate::twofloat::consts::PI;
use anyhow::Context;
use double_pendulum::Parameters;

/// A line of the table: a scene at one time.
#[derive(Clone, Debug)]
pub struct KnownAnswer {
    pub scene: &'static str,
    /// As written in the file, with commas between them. Angles are in degrees.
    pub given: &'static str,
    pub start: Reference,
    pub parameters: Parameters<f64>,
    pub time: f64,
    pub directions: [TwoFloat; 4],
    pub radius: [f64; 4],
    pub growth: f64,
}

/// Angles are in degrees.
pub const HEADING: &str =
    "scene,a1_deg,a2_deg,w1_start,w2_start,m1,m2,l1,l2,g,t,sin_a1,cos_a1,sin_a2,cos_a2,growth";
const GIVEN: usize = 11;

/// Returns every line, in the file's order.
pub fn table() -> anyhow::Result<Vec<KnownAnswer>> {
    let lines = include_str!("../known_answers.csv").lines().skip(1);
    lines
        .map(|line| {
            KnownAnswer::read(line)
                .with_context(|| format!("known_answers.csv: cannot read `{line}`"))
        })
        .collect()
}

impl KnownAnswer {
    fn read(line: &'static str) -> Option<Self> {
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

/// Parses a decimal number of up to 38 digits.
fn decimal(text: &str) -> Option<TwoFloat> {
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
