//! The hard cases: motions that break a careless arithmetic, and how far off the direction form may be on them.

use double_pendulum::{Equations, Error, Method, Numbers, Parameter, Parameters, State};

use crate::oracle::trials::{Trial, largest_difference};

/// A motion, and starts like it, each a little farther on: one start's error is an accident, that of many is not.
#[derive(Clone, Copy, Debug)]
pub struct HardCase {
    /// For messages.
    pub name: &'static str,
    /// The first start.
    pub trial: Trial,
    /// How far the angle of rod 1 is turned from one start to the next, rad; that of rod 2 half as far.
    pub spread: f64,
    /// The typical error of compensated `f32` with the finest steps, at most, rad.
    pub floor: f64,
    /// The error of `f64` with the finest steps, at most, rad: the method's own.
    pub method: f64,
    /// The error in fixed point of 32 and 64 bits below which a halved step need not be better, and within which the finest is, rad:
    /// twice to four times what was measured, at most `floor` but with a heavy elbow and near the upright position. With a heavy elbow
    /// the unit of time in 32 bits, which goes with the step, is half of what it may be (in steps a quarter longer the error is a third,
    /// measured 2.8e-8). Near the upright position 2^-30 of a sine near 0 is more than an `f32` would lose; in 64 bits the roundings of
    /// each step add up, for no sum is compensated. NaN: what is refused, for masses of too unlike a size, or because the light elbow
    /// needs steps finer than any here.
    pub fixed: [f64; 2],
    /// How many times more plain sums lose in angles, whose last place is coarse: far turns away, or where an error grows as it falls.
    pub in_angles: f64,
    /// By how much halving the step may make a typical error grow.
    pub growth: f64,
    /// Why it is hard, and why the budgets are what they are.
    pub reason: &'static str,
}

/// The steps tried, 2^-k s.
pub const HALVINGS: std::ops::RangeInclusive<i32> = 4..=13;

/// Starts of a case. The logarithm of an error at its floor spreads by about 0.5, the mean of so many by 0.1.
const STARTS: u32 = 24;

/// Plain sums with the finest steps, over the floor of compensated ones: measured up to 610.
const PLAIN: f64 = 2000.0;

/// Rods of 1 m, bobs of 1 kg, from rest at 0.5 rad.
const REGULAR: HardCase = HardCase {
    name: "regular",
    trial: Trial {
        parameters: Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.81 },
        start: State { a1: 0.5, a2: 0.5, p1: 0.0, p2: 0.0 },
        seconds: 2.0,
    },
    spread: 1e-3,
    floor: 1.2e-8,
    fixed: [2e-9, 2e-12],
    method: 1e-14,
    in_angles: 1.0,
    growth: 1.5,
    reason: "no chaos: what is left is the rounding of the evaluations, 6e-8 each, averaged over the steps",
};

const fn parameters([m1, m2]: [f64; 2], [l1, l2]: [f64; 2], g: f64) -> Parameters<f64> {
    Parameters { m1, m2, l1, l2, g }
}

const fn trial(parameters: Parameters<f64>, [a1, a2, p1, p2]: [f64; 4], seconds: f64) -> Trial {
    Trial { parameters, start: State { a1, a2, p1, p2 }, seconds }
}

const EVEN: [f64; 2] = [1.0, 1.0];
const G: f64 = 9.81;
const HALF: [f64; 4] = [0.5, 0.5, 0.0, 0.0];
/// 179.9 degrees.
const NEAR_UPRIGHT: f64 = 3.139_847_324_337_799;

/// The table of hard cases. The floors are twice those measured.
pub const HARD_CASES: [HardCase; 11] = [
    REGULAR,
    HardCase {
        name: "chaotic",
        trial: trial(parameters(EVEN, EVEN, G), [2.0, 2.0, 0.0, 0.0], 3.0),
        floor: 1.5e-7,
        fixed: [3e-8, 3e-11],
        method: 1e-12,
        reason: "it turns over; a small error grows by 10 or more in 3 s",
        ..REGULAR
    },
    HardCase {
        name: "near-upright",
        trial: trial(parameters(EVEN, EVEN, G), [NEAR_UPRIGHT, NEAR_UPRIGHT, 0.0, 0.0], 4.0),
        spread: -1e-5,
        floor: 6e-7,
        fixed: [5e-5, 1e-8],
        method: 3e-12,
        in_angles: 1e3,
        growth: 15.0,
        reason: "179.9 degrees: a small error grows by e every 0.17 s while it falls",
    },
    HardCase {
        name: "heavy elbow",
        trial: trial(parameters([1.0, 1e-3], EVEN, G), HALF, 2.0),
        floor: 6e-8,
        fixed: [1.7e-7, 3e-11],
        reason: "mass ratio 1e-3: bob 2 hardly moves bob 1, whose momentum is a thousand times its own",
        ..REGULAR
    },
    HardCase {
        name: "far heavier elbow",
        trial: trial(parameters([1.0, 1e-6], EVEN, G), HALF, 2.0),
        floor: 8e-8,
        fixed: [f64::NAN; 2],
        reason: "mass ratio 1e-6: near resonance, whose growth bob 1 alone limits",
        ..REGULAR
    },
    HardCase {
        name: "light elbow",
        trial: trial(parameters([1.0, 1e3], EVEN, G), HALF, 1.0),
        floor: 3e-6,
        fixed: [f64::NAN, 5e-10],
        method: 1e-10,
        reason: "mass ratio 1e3: p1 - p2 cos D is a thousandth of its terms, and so are the digits left of it in f32",
        ..REGULAR
    },
    HardCase {
        name: "rods 100:1",
        trial: trial(parameters(EVEN, [1.0, 0.01], G), HALF, 1.0),
        floor: 3e-7,
        fixed: [3e-7, 4e-12],
        method: 1e-11,
        reason: "the short rod 2 swings seven times as fast as rod 1",
        ..REGULAR
    },
    HardCase {
        name: "rods 1:100",
        trial: trial(parameters(EVEN, [0.01, 1.0], G), HALF, 1.0),
        floor: 2.5e-7,
        fixed: [5e-8, 3e-12],
        method: 3e-10,
        reason: "the short rod 1 swings at 44 rad/s: a step of 2^-4 s is beyond the limit of stability",
        ..REGULAR
    },
    HardCase {
        name: "no gravity",
        trial: trial(parameters(EVEN, EVEN, 0.0), [0.5, -0.5, 2.0, 1.0], 2.0),
        floor: 1.6e-8,
        fixed: [4e-9, 3e-12],
        method: 2e-15,
        reason: "the unit of time is not that of gravity; at the floor in f64 too, a few roundings",
        ..REGULAR
    },
    HardCase {
        name: "whirling",
        trial: trial(parameters(EVEN, EVEN, G), [0.0, 0.0, 150.0, 100.0], 1.0),
        floor: 3e-7,
        fixed: [1e-7, 4e-12],
        method: 2e-9,
        reason: "50 rad/s: eight turns in the second",
        ..REGULAR
    },
    HardCase {
        name: "far angles",
        trial: trial(parameters(EVEN, EVEN, G), [1000.0, -1000.0, 0.0, 0.0], 2.0),
        floor: 3e-8,
        fixed: [7e-9, 6e-12],
        method: 1e-12,
        in_angles: 1e3,
        growth: 2.0,
        reason: "159 turns away: in a plain f32 the angle's last place is 6e-5 rad",
        ..REGULAR
    },
];

impl HardCase {
    /// What halving the step may make of a typical error, above what error, and the most that the finest steps leave.
    pub fn budget(&self, method: Method) -> [f64; 3] {
        let &Self { floor, method: own, fixed: [words, long_words], growth, .. } = self;
        let plain = PLAIN * floor * if method.equations() == Equations::Directions { 1.0 } else { self.in_angles };
        let double = own.max(plain * f64::EPSILON / f64::from(f32::EPSILON));
        match method.numbers() {
            Numbers::CompensatedF32 => [growth, growth * own * f64::from(f32::EPSILON), floor],
            Numbers::Fixed32 => [1.5, words, words],
            Numbers::Fixed64 => [1.5, long_words, long_words],
            Numbers::F32 => [2.0 * growth, plain, plain],
            Numbers::F64 | Numbers::CompensatedF64 => [growth, double, double],
        }
    }

    /// The first start and those like it.
    pub fn starts(&self) -> impl Iterator<Item = Trial> + '_ {
        (0..STARTS).map(|i| {
            let on = f64::from(i) * self.spread;
            let State { a1, a2, p1, p2 } = self.trial.start;
            Trial { start: State { a1: a1 + on, a2: a2 + 0.5 * on, p1, p2 }, ..self.trial }
        })
    }

    /// The typical error of `method` over `starts`, whose exact states are given too, for each of the [`HALVINGS`] that is not refused as too
    /// long a step: the geometric mean, rad; infinite where a motion is lost.
    pub fn typical_errors(method: Method, starts: &[(Trial, Vec<State<f64>>)]) -> Result<Vec<f64>, Error> {
        let mut errors = Vec::new();
        for halvings in HALVINGS {
            let error = |(trial, exact): &(Trial, Vec<State<f64>>)| {
                let states = trial.states(method, 0.5_f64.powi(halvings))?;
                Ok(largest_difference(&states, exact).max(f64::MIN_POSITIVE).ln())
            };
            match starts.iter().map(error).sum::<Result<f64, Error>>() {
                Ok(logarithms) => errors.push((logarithms / starts.len() as f64).exp()),
                Err(Error::TooLarge { parameter: Parameter::Dt, .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(errors)
    }
}
