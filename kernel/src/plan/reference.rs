//! The reference: a run in 64 bits that measures the truncation errors of its own steps
//! ([`Truncation`]).

use super::Problem;
use super::run::{Directions, Run};
use crate::error::Error;
use crate::methods::any::Motion64;
use crate::methods::{StepErrors, Truncation};
use crate::pendulum::State;

/// The run in 64 bits that all others are compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reference {
    pub run: Run<Motion64>,
    /// The errors of the steps since the last comparison.
    truncation: Truncation,
    /// The standard deviation of the rounding error of a step.
    rounding: [f32; 4],
}

/// The reference at a comparison, with the errors that it has made since the last one: of a1 and a2,
/// rad, and of p1 and p2, in units of the `scales` of the caller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Compared {
    pub directions: Directions,
    /// The bound of the truncation error.
    pub truncation: [f32; 4],
    /// The standard deviation of the rounding error of a step, and the number of steps.
    pub rounding: [f32; 4],
    pub steps: f32,
}

impl Reference {
    /// Creates a reference that is not prepared yet.
    pub fn new(run: Run<Motion64>) -> Self {
        Self {
            run,
            truncation: Truncation::default(),
            rounding: [f32::NAN; 4],
        }
    }

    /// Prepares the motion of a problem at `start`.
    pub fn prepare(&mut self, problem: &Problem, start: &State<f64>) -> Result<(), Error> {
        self.run.prepare(problem, start)?;
        if let Some(motion) = &self.run.motion {
            (self.truncation, self.rounding) = motion.errors();
        }
        Ok(())
    }

    /// Makes steps towards the next comparison, as [`Run::advance`] does.
    pub fn advance(&mut self, price: f32, cost: f32, spent: f32) -> f32 {
        let steps = self.run.take(price, cost, spent);
        if let (Some(motion), 1..) = (&mut self.run.motion, steps) {
            motion.measure(steps, &mut self.truncation);
        }
        price * steps as f32
    }

    /// Returns the comparison, and begins the next one.
    pub fn compare(&mut self, scales: [f64; 2]) -> Compared {
        let [of_p1, of_p2] = scales.map(|scale| 1.0 / scale as f32);
        let units = [1.0, 1.0, of_p1, of_p2];
        let scaled = |errors: StepErrors| core::array::from_fn(|i| errors[i] * units[i]);

        let sums = self.truncation.take();
        let truncation = match &self.run.motion {
            Some(motion) => motion.bounds(&sums),
            None => [f32::NAN; 4],
        };
        let rounding = scaled(self.rounding);
        let steps = self.run.stepping.steps as f32;
        Compared {
            directions: self.run.frame(),
            truncation: scaled(truncation),
            rounding,
            steps,
        }
    }
}
