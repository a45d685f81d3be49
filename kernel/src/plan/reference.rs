//! The reference: a run in 64 bits that measures the truncation error of its own steps.
//!
//! A step of order 10 contains the same step of order 8 and of order 6, whose errors d8 and d6 cost
//! a few additions ([`Truncation`]). If the rows k = n .. 5 are extrapolated, the first term of the
//! error is proportional to h^(2m)/(n ... 5)^2, with m = 6 - n rows of steps h/k (`[Hairer I]`,
//! section II.9). So the quotient of the errors of two orders is 4 times as large for n = 1 and 2
//! as for n = 2 and 3, and the step itself has an error of about x d8. The bound is
//!
//! ```text
//! T = d8 max(1, x)        x = 4 d8/d6
//! ```
//!
//! If x is above 1, the step does not resolve the motion, and T is larger than d8. Steps
//! whose d8 is no larger than its own rounding error count as exact.

use super::Problem;
use super::run::{Directions, Run};
use crate::error::Error;
use crate::methods::any::Motion64;
use crate::methods::{StepErrors, Truncation};
use crate::pendulum::State;

/// (2/1)^2: how much less the errors fall from order 8 to order 10 than from order 6 to order 8.
const NEXT: f32 = 4.0;

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
        let orders = match &self.run.motion {
            Some(motion) => motion.lower_orders(&sums),
            None => [[f32::NAN; 4]; 2],
        };
        let [d8, d6] = orders.map(scaled);
        let rounding = scaled(self.rounding);
        let steps = self.run.stepping.steps as f32;
        Compared {
            directions: self.run.frame(),
            truncation: of_steps(d8, d6),
            rounding,
            steps,
        }
    }
}

/// Returns the bound T of the errors of steps.
fn of_steps(d8: [f32; 4], d6: [f32; 4]) -> [f32; 4] {
    let [size8, size6] = [d8, d6].map(|errors| errors.iter().sum::<f32>());
    if size8 == 0.0 {
        return [0.0; 4];
    }
    let growth = f32::max(1.0, NEXT * size8 / size6);
    d8.map(|d8| d8 * growth)
}
