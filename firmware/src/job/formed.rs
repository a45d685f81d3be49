//! The fast forms of the kernel.

use double_pendulum::form::{AngleForm, Direction, Form, Stepper};
use double_pendulum::{Real, State};

use super::run::{Run, checked};
use super::{JobError, Request};

/// A form with its motion; `DIRECTED` if it knows directions only.
#[derive(Clone, Copy, Debug)]
pub struct Formed<R: Real, F: Form<R>, const DIRECTED: bool> {
    stepper: Stepper<R, F>,
}

/// The angle form with the sums `S`.
pub type Angles<R, S> = Formed<R, AngleForm<R, S>, false>;
/// A direction form `F`.
pub type Directions<R, F> = Formed<R, F, true>;

impl<R: Real, F: Form<R>, const DIRECTED: bool> Run for Formed<R, F, DIRECTED> {
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
        DIRECTED.then(|| self.stepper.directions().map(|direction| direction.map(R::to_f64)))
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        self.stepper.bits(feed);
    }
}
