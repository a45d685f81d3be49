//! What a row of the answer holds.

use double_pendulum::{Error, Motion, Parameter, Pendulum, State};

/// What one row of the answer holds, SI units. The state is widened, which loses nothing, and of the fast forms given to the
/// last digit they carry; what follows from it is computed in double precision.
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
    pub(super) fn new(pendulum: &Pendulum<f64>, state: State<f64>) -> Self {
        let Motion { w1, w2, .. } = pendulum.to_motion(&state);
        Self { state: state.into(), velocities: [w1, w2], energy: pendulum.energy(&state) }
    }

    /// The reading itself if all its numbers are finite, else [`Error::Diverged`].
    pub(super) fn finite(self) -> Result<Self, Error> {
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
