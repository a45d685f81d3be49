//! A request being answered.

use double_pendulum::parts::Turns;
use double_pendulum::{Error, Motion, Parameter, Pendulum};

use super::{OnBoards, Reading, Request, Run};

/// A request being answered: computes the samples one after the other, a bounded amount of work at a time. It counts the
/// whole turns of a motion that does not.
#[derive(Clone, Copy, Debug)]
pub struct Job<R = OnBoards> {
    run: R,
    /// As the arithmetic holds it.
    pendulum: Pendulum<f64>,
    /// Of a motion that does not count its own.
    turns: Option<[Turns; 2]>,
    stride: u32,
    /// Samples given so far; wraps.
    pub given: u32,
    /// Samples still to come, the one at the start included.
    left: u32,
    /// Steps until the next of them.
    steps: u32,
}

impl<R: Run> Job<R> {
    /// By the request's motion at its start.
    pub fn new(run: R, request: &Request) -> Result<Self, Error> {
        let Request {
            method,
            angles,
            stride,
            samples,
            ..
        } = *request;
        let parameters = request.parameters;
        let parameters = if method.is_single() {
            parameters.cast::<f32>().cast()
        } else {
            parameters
        };
        let pendulum = Pendulum::new(&parameters)?;
        let turns = run
            .sides()
            .map(|sides| Turns::of(angles, sides))
            .transpose()?;
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

    /// Whether every sample has been given.
    pub fn is_finished(&self) -> bool {
        self.left == 0
    }

    /// Computes at most one step; the reading, when a sample is due.
    ///
    /// Ends with [`Error::Diverged`] instead of a reading that is not finite: every one given before it is.
    pub fn advance(&mut self) -> Result<Option<Reading>, Error> {
        if self.is_finished() {
            return Ok(None);
        }
        if self.steps > 0 {
            self.step();
        }
        if self.steps > 0 {
            return Ok(None);
        }
        (self.given, self.left, self.steps) =
            (self.given.wrapping_add(1), self.left - 1, self.stride);
        self.reading().map(Some).inspect_err(|_| self.left = 0)
    }

    /// Lets `advance` make steps and nothing else, for their time to be measured: no sample after them is right.
    pub fn measure<T>(&mut self, advance: impl FnOnce(&mut R) -> T) -> T {
        self.left = 0;
        advance(&mut self.run)
    }

    fn step(&mut self) {
        self.run.advance(1);
        self.steps -= 1;
        if let (Some(turns), Some(sides)) = (&mut self.turns, self.run.sides()) {
            Turns::observe(turns, sides);
        }
    }

    fn reading(&self) -> Result<Reading, Error> {
        let state = self.run.state();
        let state = self
            .turns
            .map_or(state, |turns| Turns::unwrap(&turns, state))
            .finite()?;
        let (Motion { w1, w2, .. }, energy) = (
            self.pendulum.to_motion(&state),
            self.pendulum.energy(&state),
        );
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

/// Gives every reading of `request` to `each`, the one at the start first.
pub(super) fn readings<E: From<Error>>(
    run: impl Run,
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
