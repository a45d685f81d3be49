//! The hard cases, `exact/hard_cases.csv`: motions that careless arithmetic computes wrongly,
//! and the allowed errors of the direction form.

use double_pendulum::{Parameters, State};

use crate::trials::Trial;

/// A motion, and starts near it. The typical error of many starts is meaningful, while that of one
/// start can be accidental: it is the geometric mean of the largest errors of 24 starts in
/// compensated `f32`, 8 in plain `f32` and 32-bit fixed point, and 1 otherwise.
#[derive(Clone, Copy, Debug)]
pub struct HardCase {
    pub name: &'static str,
    pub trial: Trial,
    /// The difference of rod 1's angle from one start to the next, rad; rod 2's is half of it.
    pub spread: f64,
    /// The largest allowed typical error of compensated `f32` with the finest steps, rad. It is
    /// twice the measured error. In plain `f32` in directions 2000 times this error is allowed.
    pub floor: f64,
    /// The typical error in fixed point of 32 and 64 bits, rad. Below it a halved step need not be
    /// better, and the error of the finest step must be within it.
    ///
    /// It is twice to four times the measured error, and at most `floor` except with a heavy elbow
    /// and near the upright position. NaN means that the fixed point of these bits must refuse the
    /// case, because the masses differ too much, or because the light elbow needs finer steps than
    /// any here.
    ///
    /// With a heavy elbow the unit of time in 32 bits, which depends on the step, is half of its
    /// largest value (in steps that are a quarter longer the error is a third, measured 2.8e-8).
    /// Near the upright position an error of 2^-30 of a sine near 0 exceeds an `f32`'s error. In 64
    /// bits the roundings of each step accumulate, because no sum is compensated.
    pub fixed: [f64; 2],
    /// The largest allowed error of `f64`, plain or compensated, with the finest steps, rad. It is
    /// the error of the method. If the allowed error of plain `f32` by the same equations, times
    /// 2^-29, the ratio of the epsilons, is larger, that is allowed instead.
    pub method: f64,
    /// The allowed error of plain sums in angles, `f32` or `f64`, over that in directions. The last
    /// place of an angle is coarse many turns away, and an error grows while the pendulum falls.
    pub in_angles: f64,
    /// The largest allowed ratio of the typical errors with a halved step and with the whole step.
    /// In plain `f32` it is twice this, and in fixed point 1.5. It does not apply if the error with
    /// the whole step is above 0.1 rad or, except in compensated `f32`, if the error with the
    /// halved step is allowed for the finest steps.
    pub growth: f64,
    /// The reason why the case is hard, and the reasons for the allowed errors.
    pub reason: &'static str,
}

pub fn hard_cases() -> Vec<HardCase> {
    let lines = include_str!("../hard_cases.csv").lines().skip(1);
    lines
        .map(|line| {
            HardCase::read(line).unwrap_or_else(|| panic!("hard_cases.csv: cannot read `{line}`"))
        })
        .collect()
}

impl HardCase {
    fn read(line: &'static str) -> Option<Self> {
        // The reason is last and in quotes, so that it may contain commas.
        let (line, reason) = line.strip_suffix('"')?.split_once(",\"")?;
        let (name, numbers) = line.split_once(',')?;
        let numbers: Vec<f64> = numbers
            .split(',')
            .map(|text| text.parse().ok())
            .collect::<Option<_>>()?;

        let &[m1, m2, l1, l2, g, a1, a2, p1, p2, seconds, ref budgets @ ..] = numbers.as_slice()
        else {
            return None;
        };
        let &[spread, floor, fixed32, fixed64, method, in_angles, growth] = budgets else {
            return None;
        };
        let trial = Trial {
            parameters: Parameters { m1, m2, l1, l2, g },
            start: State { a1, a2, p1, p2 },
            seconds,
        };
        Some(Self {
            name,
            trial,
            spread,
            floor,
            fixed: [fixed32, fixed64],
            method,
            in_angles,
            growth,
            reason,
        })
    }
}
