//! A motion computed on request: the same code answers `cargo simulate` on the host and over the serial link.

mod choice;
mod request;
mod run;
mod ways;

use double_pendulum::{Error, Parameter};

pub use choice::{Arithmetic, Formulation, Model};
pub use request::Request;
pub use ways::{Job, JobError};

/// What one row of the answer holds, SI units. `f32` results are widened, which loses nothing; those of the fast forms are
/// given to the last digit they carry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// a1, a2 (rad), p1, p2 (kg m^2/s).
    pub state: [f64; 4],
    /// w1, w2, rad/s.
    pub velocities: [f64; 2],
    /// Energy, J; zero potential at the pivot.
    pub energy: f64,
}

impl Reading {
    /// The reading itself if all its numbers are finite, else [`Error::Diverged`].
    fn finite(self) -> Result<Self, Error> {
        let ([a1, a2, p1, p2], [w1, w2]) = (self.state, self.velocities);
        let numbers = [
            (Parameter::A1, a1),
            (Parameter::A2, a2),
            (Parameter::P1, p1),
            (Parameter::P2, p2),
            (Parameter::W1, w1),
            (Parameter::W2, w2),
            (Parameter::Energy, self.energy),
        ];
        match numbers.into_iter().find(|(_, value)| !value.is_finite()) {
            None => Ok(self),
            Some((parameter, value)) => Err(Error::Diverged { parameter, value }),
        }
    }
}
