//! The direction form in 64 bits of fixed point, by extrapolation: many digits for chips without a unit for them.

mod motion;
mod rows;

use motion::Fixed64State;

use crate::bounds::check_step;
use crate::error::Error;
use crate::methods::Form;
use crate::methods::scaling::lost;
use crate::numbers::{Real, Sealed};
use crate::pendulum::{Direction, Parameters, State};

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
pub struct Fixed64<const ORDER: u32> {
    parameters: Parameters<f64>,
    dt: f64,
}

impl<const ORDER: u32> Sealed for Fixed64<ORDER> {}

#[doc(hidden)]
impl<const ORDER: u32> Form for Fixed64<ORDER> {
    type Real = f32;
    type Carried = Fixed64State;
    type Side = i32;

    fn new(parameters: &Parameters<f64>, dt: f64) -> Result<Self, Error> {
        parameters.check()?;
        check_step::<f64>(dt)?;
        Ok(Self { parameters: *parameters, dt })
    }

    fn start(&self, state: &State<f64>) -> Result<Self::Carried, Error> {
        state.check()?;
        Fixed64State::start(&self.parameters, self.dt, ORDER, state)
    }

    #[inline]
    fn advance(&self, carried: &mut Self::Carried, steps: u32) {
        carried.advance(steps);
    }

    fn check(&self, carried: &Self::Carried) -> Result<(), Error> {
        lost(carried.is_lost())
    }

    fn heads(carried: &Self::Carried) -> [Direction<i32>; 2] {
        carried.heads()
    }

    fn directions<R: Real>(&self, carried: &Self::Carried) -> [Direction<R>; 2] {
        carried.directions()
    }

    fn momenta<R: Real>(&self, carried: &Self::Carried) -> [R; 2] {
        carried.momenta()
    }

    fn state(&self, carried: &Self::Carried) -> State<f64> {
        carried.state()
    }

    fn bits(carried: &Self::Carried, feed: impl FnMut(u64)) {
        carried.bits(feed);
    }
}
