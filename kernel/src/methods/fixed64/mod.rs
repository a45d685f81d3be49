//! The direction form in 64 bits of fixed point, by extrapolation: many digits for chips without a unit for them.

mod rows;

use core::cell::Cell;

use crate::bounds::check_step;
use crate::error::{Error, Parameter};
use crate::methods::Form;
use crate::methods::scaling::{Scaling, lost};
use crate::numbers::fixed::Q64;
use crate::numbers::{Real, Scalar, Sealed};
use crate::pendulum::directions::{lower_ray, quantities, rod_directions, state_of};
use crate::pendulum::{Direction, Parameters, Pendulum, State};
use rows::{EIGHTH, Rows, unit_of_time};

/// As [`ExtrapolationF64`](super::ExtrapolationF64), but on integers of 64 bits, row after row. For any masses and rods whose
/// scaled ratios are below some 4,000 (others are refused by name), and any start.
///
/// The energy of the motion chooses a unit of time at its start, from the [bounds](crate::Bounds) that no motion of that
/// energy exceeds: in it every rate and momentum is at most 1/8, torques of gravity 1/256. Directions are kept in eighths.
/// Products of such fractions need no shift for their point, and hardly any for their units.
///
/// A step of more than 15 of these units, or in which the fastest rate would turn a rod by more than 1.5 rad, is refused with
/// the longest there may be. What a stage of a step may overshoot, a factor of 2 in every quantity, is looked at in every
/// stage: given that, no sum and no product can leave its 64 bits (argued at each in `rows.rs`). A motion that ever exceeded
/// it, because the steps were too coarse and its energy grew, is lost, its state is NaN and
/// [`Run::advance`](crate::Run::advance) says so. Nothing is clamped.
///
/// Error in 10 s of regular motion (0.5 rad, rods of 1 m) by order 12: below 1e-12 rad with 12 steps a second; chaotic, as
/// much as in `f64` at the same steps, or 1e-12 rad after 5 s (2 rad), where roundings are all there is (the repository's tests
/// assert both). These come to 2e-13 rad by order 8, 7e-13 by order 12 and 3e-12 by order 16, however short the steps, in `f64`
/// to 1e-13 or so. No rounding leans to one side, or all steps would add it up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed64<const ORDER: u32>(Fixed64State);

/// A motion of whichever order: the code of all orders is here once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed64State {
    rows: Rows,
    /// P1 and P2 to a kg m^2/s.
    momenta: [f64; 2],
    /// 1/(2 nu^2) by 8.
    half_inverse_square: Q64,
    /// sin a1, cos a1, S, C by 8; P1, P2.
    z: [Q64; 6],
    lost: bool,
    /// nu and 1/nu.
    norm: f64,
    inverse_norm: f64,
    /// What a step loses by rounding down.
    floored: [i16; 2],
}

/// The greatest rate, the greatest torque of gravity, and the longest step in the units of the motion.
const RATE: f64 = 0.125;
const TORQUE: f64 = 1.0 / 256.0;
const STEP: f64 = 15.0;

/// 1 as the square of a length, by 64, and 1/2 by 8.
const ONE: Q64 = Q64(1 << 58);
const HALF: Q64 = Q64(1 << 60);

/// By how much a rod may turn in a step, rad.
const TURN: f64 = 1.5;

/// 2^-8, by how much a step may alter the square of a length, by 64.
const LENGTH: u64 = 1 << 50;

impl<const ORDER: u32> Sealed for Fixed64<ORDER> {}

#[doc(hidden)]
impl<const ORDER: u32> Form for Fixed64<ORDER> {
    type Real = f32;
    type Side = i32;

    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        Fixed64State::new(parameters, start, dt, ORDER).map(Self)
    }

    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        start.check()?;
        Ok(Self(self.0.started(start)))
    }

    #[inline]
    fn advance(&mut self, steps: u32) {
        self.0.advance(steps);
    }

    fn check(&self) -> Result<(), Error> {
        lost(self.0.lost)
    }

    fn rod_directions(&self) -> [Direction<i32>; 2] {
        rod_directions(&self.0.z).map(|direction| direction.map(|x| (x.0 >> 32) as i32))
    }

    fn directions<R: Real>(&self) -> [Direction<R>; 2] {
        let [sin1, cos1, s, c, ..] = self.0.z;
        let inverse = R::from_f64(self.0.inverse_norm);
        let lower = lower_ray([sin1, cos1], [s, c]).map(|z| z.over::<R>(EIGHTH * EIGHTH) * inverse);
        [[sin1, cos1].map(|z| z.over(EIGHTH)), lower]
    }

    #[inline(never)] // one copy
    fn momenta<R: Real>(&self) -> [R; 2] {
        let ([.., p1, p2], [unit1, unit2]) = (self.0.z, self.0.momenta);
        let lost = self.0.lost;
        let momentum = |p: Q64, unit: f64| {
            if lost {
                R::from_f64(f64::NAN)
            } else {
                p.over::<R>(1.0) / R::from_f64(unit)
            }
        };
        [momentum(p1, unit1), momentum(p2, unit2)]
    }

    fn state(&self) -> State<f64> {
        self.0.state()
    }

    fn bits(&self, mut feed: impl FnMut(u64)) {
        self.0.z.iter().for_each(|&z| feed(z.0 as u64));
        feed(u64::from(self.0.lost));
    }
}

impl Fixed64State {
    #[inline(never)]
    fn new(
        parameters: &Parameters<f64>,
        start: &State<f64>,
        dt: f64,
        order: u32,
    ) -> Result<Self, Error> {
        let pendulum = Pendulum::new(parameters)?;
        check_step::<f64>(dt)?;
        start.check()?;
        let bounds = pendulum.bounds(start);
        let seconds = Scaling::in_seconds(parameters)?;
        let [by_rates, by_torques] = seconds.longest(&bounds, [RATE, TORQUE]);
        let longest = libm::fmin(by_rates, by_torques);
        let limit = libm::fmin(STEP * longest, TURN / RATE * by_rates);
        if libm::fabs(dt) > limit {
            return Err(Error::TooLarge {
                parameter: Parameter::Dt,
                value: dt,
                limit,
            });
        }
        let scaling = seconds.in_unit(unit_of_time(longest, dt));
        let rows = Rows::new(order, &scaling, dt)?;
        let motion = Self {
            floored: rows.floored(),
            rows,
            momenta: scaling.momenta,
            norm: scaling.norm,
            half_inverse_square: Q64::from_f64(0.5 / (scaling.norm * scaling.norm) * EIGHTH),
            z: [Q64(0); 6],
            inverse_norm: 1.0 / scaling.norm,
            lost: false,
        };
        Ok(motion.started(start))
    }

    fn started(&self, start: &State<f64>) -> Self {
        let [sin1, cos1, s, c, p1, p2] = quantities(start, self.norm, self.momenta);
        let [sin1, cos1, s, c] = [sin1, cos1, s, c].map(|direction| direction * EIGHTH);
        Self {
            z: [sin1, cos1, s, c, p1, p2].map(Q64::from_f64),
            lost: false,
            ..*self
        }
    }

    #[inline(never)]
    fn advance(&mut self, steps: u32) {
        for _ in 0..steps {
            self.step();
        }
    }

    fn step(&mut self) {
        let reach = Cell::new(0);
        let end = self.rows.end(&self.z, &reach);
        // Half of 2^-64 is rounded as the last digit has it, which is as often 1 as 0.
        let unfloored =
            |z: Q64, floored: i16| Q64(z.0.wrapping_add((i64::from(floored) + (z.0 & 1)) >> 1));
        let [of_p1, others] = self.floored;
        let [sin1, cos1, s, c, _, p2] = end.map(|z| unfloored(z, others));
        let p1 = unfloored(end[4], of_p1);
        let norm = self.rows.norm();
        let ([sin1, cos1], missing1) = restored([sin1, cos1], ONE, HALF);
        let ([s, c], missing2) = restored([s, c], norm * norm, self.half_inverse_square);
        self.z = [sin1, cos1, s, c, p1, p2];
        let reach = self
            .z
            .iter()
            .fold(reach.get(), |reach, z| reach | z.reach(2));
        self.lost |= reach != 0
            || [missing1, missing2]
                .into_iter()
                .any(|missing| missing.0.unsigned_abs() > LENGTH);
    }

    #[inline(never)]
    fn state(&self) -> State<f64> {
        state_of(
            if self.lost {
                [f64::NAN; 6]
            } else {
                self.z.map(Q64::value)
            },
            self.momenta,
        )
    }
}

/// The direction with its length restored to first order in what its `square` misses, and what that was; `gain` is half the
/// inverse of the square.
#[inline(always)]
fn restored([s, c]: [Q64; 2], square: Q64, gain: Q64) -> ([Q64; 2], Q64) {
    let missing = square - s * s - c * c;
    let relative = missing.up(7) * gain;
    let restored = |x: Q64| x + (x * relative).up(2);
    ([restored(s), restored(c)], missing)
}
