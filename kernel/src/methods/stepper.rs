//! A form together with one motion in it.

use super::Form;
use crate::error::Error;
use crate::numbers::Real;
use crate::pendulum::{Direction, Parameters, State};

/// One motion, stepped by the form `F`, unchecked and without its turns: what [`Run`](super::Run) is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepper<F: Form> {
    pub(super) form: F,
    pub(super) carried: F::Carried,
}

impl<F: Form> Stepper<F> {
    /// The motion from `start` in steps of `dt` seconds.
    ///
    /// Refuses what [`Form::new`] and [`Form::start`] refuse.
    pub fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        let form = F::new(parameters, dt)?;
        Ok(Self { form, carried: form.start(start)? })
    }

    /// Makes `steps` steps ([`Form::advance`]).
    #[inline(always)]
    pub fn advance(&mut self, steps: u32) {
        self.form.advance(&mut self.carried, steps);
    }

    /// Refuses a motion that has left the finite numbers ([`Form::check`]).
    pub fn check(&self) -> Result<(), Error> {
        self.form.check(&self.carried)
    }

    /// Where the rods point, (sin, cos) each ([`Form::directions`]).
    #[inline]
    pub fn directions<Q: Real>(&self) -> [Direction<Q>; 2] {
        self.form.directions(&self.carried)
    }

    /// The signs of the directions.
    #[inline]
    pub fn sides(&self) -> [[i32; 2]; 2] {
        F::heads(&self.carried).map(|direction| direction.map(super::Side::sign))
    }

    /// The momenta that go with the directions ([`Form::momenta`]).
    pub fn momenta<Q: Real>(&self) -> [Q; 2] {
        self.form.momenta(&self.carried)
    }

    /// The canonical state in SI units ([`Form::state`]).
    pub fn state(&self) -> State<f64> {
        self.form.state(&self.carried)
    }

    /// Gives `feed` the bit patterns of all that is carried ([`Form::bits`]).
    pub fn bits(&self, feed: impl FnMut(u64)) {
        F::bits(&self.carried, feed);
    }
}
