//! The hard cases, `data/hard_cases.csv`: motions that break a careless arithmetic, and how far off the direction form may be on them.

use double_pendulum::{Parameters, State};

use crate::oracle::trials::Trial;

/// A motion, and starts like it, each a little farther on: one start's error is an accident, that of many is not.
#[derive(Clone, Copy, Debug)]
pub struct HardCase {
    /// For messages.
    pub name: &'static str,
    /// The first start.
    pub trial: Trial,
    /// How far the angle of rod 1 is turned from one start to the next, rad; that of rod 2 half as far.
    pub spread: f64,
    /// The typical error of compensated `f32` with the finest steps, at most, rad: twice what was measured.
    pub floor: f64,
    /// The error in fixed point of 32 and 64 bits below which a halved step need not be better, and within which the finest is, rad:
    /// twice to four times what was measured, at most `floor` but with a heavy elbow and near the upright position. With a heavy elbow
    /// the unit of time in 32 bits, which goes with the step, is half of what it may be (in steps a quarter longer the error is a third,
    /// measured 2.8e-8). Near the upright position 2^-30 of a sine near 0 is more than an `f32` would lose; in 64 bits the roundings of
    /// each step add up, for no sum is compensated. NaN: what is refused, for masses of too unlike a size, or because the light elbow
    /// needs steps finer than any here.
    pub fixed: [f64; 2],
    /// The error of `f64` with the finest steps, at most, rad: the method's own.
    pub method: f64,
    /// How many times more plain sums lose in angles, whose last place is coarse: far turns away, or where an error grows as it falls.
    pub in_angles: f64,
    /// By how much halving the step may make a typical error grow.
    pub growth: f64,
    /// Why it is hard, and why the budgets are what they are.
    pub reason: &'static str,
}

/// Every line, in the file's order.
pub fn hard_cases() -> Vec<HardCase> {
    let lines = include_str!("../../data/hard_cases.csv").lines().skip(1);
    lines
        .map(|line| {
            HardCase::read(line).unwrap_or_else(|| panic!("hard_cases.csv: cannot read `{line}`"))
        })
        .collect()
}

impl HardCase {
    fn read(line: &'static str) -> Option<Self> {
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
