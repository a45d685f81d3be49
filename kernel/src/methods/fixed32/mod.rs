//! The direction form in 32 bits of fixed point: RK4 for chips without a floating-point unit.

#[cfg(test)]
mod search;
mod setting;
mod step;

use crate::bounds::check_step;
use crate::error::Error;
use crate::methods::Form;
use crate::methods::scaling::{Scaling, lost};
use crate::numbers::fixed::{Q30, nearest, product, scaled};
use crate::numbers::{Real, Scalar, Sealed};
use crate::pendulum::directions::{directions, quantities, rod_directions, state_of};
use crate::pendulum::{Direction, Parameters, Pendulum, State};
use setting::Setting;

/// As [`DirectionForm`](super::DirectionForm), but on integers of 32 bits, 30 of them after the point; the state has 32
/// more, which are carried from step to step. For any masses and rods whose scaled ratios are below some 4,000 (others are
/// refused by name), and any start.
///
/// Cost of a step on a Cortex-M3: some 670 cycles with rods and masses about equal, 855 with others, where half a step is
/// 3/8 to 3/64 of the unit of time; 740 and up to 915 in finer steps. On a Cortex-M0+ some 2130.
///
/// **Order 4 at any speed.** Half a step is 3 2^-n of the unit of time T, so that h/6 is a power of two of it: stages and weights
/// are exact, no time is lost. Gravity is rounded to 2^-33 of that unit; what its digits miss is given to the momenta every
/// 32 steps, less than 2^-30 each time.
///
/// **Nothing overflows.** The units of a motion follow from its energy at the start, and every 32 steps the energy is held
/// to 9/8 of that; a motion that gained more, because its steps were too coarse, is lost: its state is NaN and
/// [`Run::advance`](crate::Run::advance) says so. Nothing is clamped.
///
/// - |u| + |v| is at most [`Bounds::elbow`](crate::Bounds), for what a motion has of it with opposite signs, its mirror image
///   has with equal ones. The unit of time makes that 0.86, so |u v| is below 0.2, and momenta are of that size.
/// - With the kinetic energy K = (M11 u^2 + 2 C u v + v^2)/2 the force |u v S| is at most K nu/sqrt(m), and with the torque of
///   gravity at most 0.14.
/// - Within a step momenta change little, and the rates that go with them by less than e^(sqrt(1 + m2/m1) |w| t) in the time t:
///   so fast can r change. A step is at most half of that exponent's unit and half of T; a longer one is refused with the
///   longest there may be.
/// - How far all of this together leads in four stages, unit tests search: starts, masses, rods and steps that
///   take every sum and product furthest, at all ratios that are accepted, leave a fifth of each word free.
///
/// Error in 10 s of regular motion (0.5 rad, rods of 1 m): 1.5e-8 rad with 256 steps a second, all of it the method's, and
/// below 5e-9 with 1024 or more, where compensated `f32` stays at 3e-8 (the repository's tests assert it; nor is it worse
/// than that for mass ratios from 1/128 to 32 and unlike rods). Near the upright position `f32` is better: there sines are small,
/// and steps of 2^-30 coarse beside them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed32 {
    /// What the energy at the start chose.
    units: Setting,
    /// sin a1, cos a1, S, C, P1, P2, with 62 bits after the point.
    z: [i64; 6],
    inverse: Q30,
    /// Whether the energy was once out of range, or a length far off.
    lost: bool,
    steps: u64,
}

/// Steps from one [`renormalise`](Fixed32::renormalise) to the next.
const RENORMALISE_EVERY: u32 = 32;

/// 1 as the state has it.
const ONE: f64 = (1_u64 << 62) as f64;

/// Half of what the upper words of the state leave out: it is added to the state, so that they are rounded to nearest.
const OFFSET: i64 = 1 << 31;

/// A number of the state.
fn value(z: i64) -> f64 {
    (z - OFFSET) as f64 / ONE
}

impl Sealed for Fixed32 {}

#[doc(hidden)]
impl Form for Fixed32 {
    type Real = f32;
    type Side = i32;

    #[inline(never)]
    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        let pendulum = Pendulum::new(parameters)?;
        check_step::<f64>(dt)?;
        start.check()?;
        Ok(Self::of(
            Setting::new(parameters, pendulum.energy_above_rest(start), dt)?,
            start,
        ))
    }

    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        start.check()?;
        Ok(Self::of(self.units, start))
    }

    // A call is nothing beside such a step, and a chip's flash holds it once.
    #[inline(never)]
    fn advance(&mut self, steps: u32) {
        let mut left = steps;
        while left > 0 {
            let until_then = RENORMALISE_EVERY - self.steps as u32 % RENORMALISE_EVERY;
            let run = left.min(until_then);
            self.make(run);
            self.steps += u64::from(run);
            left -= run;
            if run == until_then {
                self.renormalise();
            }
        }
    }

    fn check(&self) -> Result<(), Error> {
        lost(self.lost)
    }

    #[inline(always)]
    fn rod_directions(&self) -> [Direction<i32>; 2] {
        rod_directions(&self.quantities()).map(|direction| direction.map(|part| part.0))
    }

    fn directions<R: Real>(&self) -> [Direction<R>; 2] {
        directions(
            &self.z.map(|z| R::from_f64(value(z))),
            R::from_f64(self.units.scaling.norm),
        )
    }

    fn momenta<R: Real>(&self) -> [R; 2] {
        let ([.., p1, p2], [unit1, unit2]) = (self.z.map(value), self.units.scaling.momenta);
        if self.lost {
            [f64::NAN; 2]
        } else {
            [p1 / unit1, p2 / unit2]
        }
        .map(R::from_f64)
    }

    #[inline(never)]
    fn state(&self) -> State<f64> {
        let known = if self.lost {
            [f64::NAN; 6]
        } else {
            self.z.map(value)
        };
        state_of(known, self.units.scaling.momenta)
    }

    fn bits(&self, mut feed: impl FnMut(u64)) {
        self.z.iter().for_each(|&z| feed(z as u64));
        feed(self.inverse.0 as u64);
        feed(u64::from(self.lost));
        feed(self.steps);
    }
}

impl Fixed32 {
    /// The motion that starts from `state`, of the energy that the units are for or less.
    fn of(units: Setting, state: &State<f64>) -> Self {
        let z = quantities(state, units.scaling.norm, units.scaling.momenta);
        let Scaling {
            inertia, shifts, ..
        } = units.scaling;
        let square = scaled(z[2] * z[2], shifts.inverse as i32 - shifts.momentum as i32);
        let inverse = Q30::from_f64(1.0 / (inertia + square));
        let z = z.map(|z| nearest(z * ONE) as i64 + OFFSET);
        Self {
            units,
            z,
            inverse,
            lost: false,
            steps: 0,
        }
    }

    /// sin a1, cos a1, S, C, P1, P2, rounded.
    #[inline(always)]
    fn quantities(&self) -> [Q30; 6] {
        self.z.map(|z| Q30((z >> 32) as i32))
    }

    /// (sin, cos) of both rods times 2^30.
    pub(super) fn q30(&self) -> [Direction<i32>; 2] {
        let [upper, lower] = rod_directions(&self.quantities());
        let ([_, inverse_square], norm) = (self.units.square, self.units.coefficients.norm);
        let over_norm = |x: Q30| ((product(x.0, norm.0) >> 30) * inverse_square) >> 29;
        [upper.map(|x| x.0), lower.map(|x| over_norm(x) as i32)]
    }
}
