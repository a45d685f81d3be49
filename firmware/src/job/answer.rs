//! The computation of a request.

use double_pendulum::parts::{Advance, Turns};
use double_pendulum::{Error, Motion, Parameter, Pendulum};

use super::{BoardMotion, Reading, Request};

/// A request that is being answered.
///
/// The job computes one sample after the other, a bounded amount of work at a time. If the method
/// does not count whole turns, the job counts them.
#[derive(Clone, Copy, Debug)]
pub struct Job<R = BoardMotion> {
    run: R,
    pendulum: Pendulum<f64>,
    /// The counters of whole turns; `None` if the method counts them.
    turns: Option<[Turns; 2]>,
    /// The number of steps from one sample to the next.
    stride: u32,
    pub given: u32,
    left: u32,
    /// The number of steps until the next sample.
    steps: u32,
}

impl<R: Advance> Job<R> {
    /// Creates the job of a request, where `run` is its motion at the start.
    pub fn new(run: R, request: &Request) -> Result<Self, Error> {
        let Request {
            angles,
            stride,
            samples,
            ..
        } = *request;
        let pendulum = Pendulum::new(&request.parameters)?;
        let turns = if run.has_turns() {
            None
        } else {
            Some(Turns::of(angles, run.sides())?)
        };
        Ok(Self {
            run,
            pendulum,
            turns,
            stride,
            given: 0,
            left: samples.saturating_add(1),
            steps: 0,
        })
    }

    pub fn is_finished(&self) -> bool {
        self.left == 0
    }

    /// Computes at most one step, and returns the reading if a sample is due. The first call
    /// computes no step and returns the initial reading. A reading with a number that is not finite
    /// ends the job.
    pub fn advance(&mut self) -> Result<Option<Reading>, Error> {
        if self.is_finished() {
            return Ok(None);
        }

        // The first call computes no step, because the initial sample is due.
        if self.steps > 0 {
            self.step();
        }
        if self.steps > 0 {
            return Ok(None);
        }

        self.given = self.given.wrapping_add(1);
        self.left -= 1;
        self.steps = self.stride;
        self.reading().map(Some).inspect_err(|_| self.left = 0)
    }

    /// Runs `advance` on the motion, so that its time can be measured. The job ends, because its
    /// later samples would be wrong.
    pub fn measure<T>(&mut self, advance: impl FnOnce(&mut R) -> T) -> T {
        self.left = 0;
        advance(&mut self.run)
    }

    fn step(&mut self) {
        self.run.advance(1);
        self.steps -= 1;
        if let Some(turns) = &mut self.turns {
            Turns::observe(turns, self.run.sides());
        }
    }

    fn reading(&self) -> Result<Reading, Error> {
        let state = self.run.state();
        let state = self
            .turns
            .map_or(state, |turns| Turns::unwrap(&turns, state))
            .finite()?;
        let Motion { w1, w2, .. } = self.pendulum.to_motion(&state);
        let energy = self.pendulum.energy(&state);

        for (parameter, value) in [
            (Parameter::W1, w1),
            (Parameter::W2, w2),
            (Parameter::Energy, energy),
        ] {
            if !value.is_finite() {
                return Err(Error::Diverged { parameter, value });
            }
        }
        Ok(Reading {
            state: state.into(),
            velocities: [w1, w2],
            energy,
        })
    }
}

/// Calls `each` with every reading of `request`, the initial one first.
pub(super) fn readings<E: From<Error>>(
    run: impl Advance,
    request: &Request,
    mut each: impl FnMut(&Reading) -> Result<(), E>,
) -> Result<(), E> {
    let mut job = Job::new(run, request)?;
    while !job.is_finished() {
        if let Some(reading) = job.advance()? {
            each(&reading)?;
        }
    }
    Ok(())
}
