//! The fast forms of the kernel.

use double_pendulum::Direction;
use double_pendulum::methods::{Form, Stepper};
use double_pendulum::{Real, State};

use super::run::{Run, checked};
use super::{JobError, Request};

/// A direction form with its motion.
#[derive(Clone, Copy, Debug)]
pub struct Directions<R: Real, F: Form<R>> {
    stepper: Stepper<R, F>,
}

impl<R: Real, F: Form<R>> Run for Directions<R, F> {
    #[inline(never)]
    fn start(request: &Request) -> Result<Self, JobError> {
        let (pendulum, state) = checked::<R>(request)?;
        Ok(Self { stepper: Stepper::new(pendulum.parameters(), &state, request.dt)? })
    }

    #[inline(always)]
    fn advance(&mut self, steps: u32) {
        self.stepper.advance(steps);
    }

    fn state(&self) -> State<f64> {
        self.stepper.state()
    }

    fn directions(&self) -> Option<[Direction<f64>; 2]> {
        Some(self.stepper.directions().map(|direction| direction.map(R::to_f64)))
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        self.stepper.bits(feed);
    }
}
