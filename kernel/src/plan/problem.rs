//! The problem to plan.

use super::cost::{Budget, Costs};
use crate::error::{Error, Parameter};
use crate::pendulum::{Motion, Parameters};
use crate::table::Method;

/// A pendulum and its start, the frames that show it, and the tolerance.
///
/// The fields are not checked until a [`Search`](super::Search) starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem {
    /// The masses, lengths and gravity.
    pub pendulum: Parameters<f64>,
    /// The angles, rad, and angular velocities, rad/s, at the start.
    pub start: Motion<f64>,
    /// The largest allowed distance of a bob from its exact position, m; more than 0. It applies to
    /// both bobs, and to the position of bob 2 relative to bob 1.
    pub tolerance: f64,
    /// The duration of the motion, s; more than 0, and at most (2^32 - 1)/`rate`. It is rounded to
    /// the nearest whole number of frames, at least one.
    pub duration: f64,
    /// The number of frames per second; at least 1.
    pub rate: u16,
}

impl Problem {
    /// Checks the problem, the costs and the budgets.
    ///
    /// Refuses a start that is not finite; a tolerance, duration, rate, price or budget that is
    /// NaN, infinite, zero or negative; and more frames than a `u32` can count, by
    /// [`Error::TooLarge`] with the longest duration, s. The error names the first of these. The
    /// pendulum is checked by the functions that use it.
    pub(super) fn check(&self, costs: &Costs, budget: &Budget) -> Result<(), Error> {
        self.start.check()?;

        // The prices and budgets, each with the parameter that an error names.
        let prices = Method::DRAWN
            .iter()
            .filter_map(|&method| Some((Parameter::Price(method), costs.step(method)?)));
        let others = [
            (Parameter::Price(Method::Rk4Fixed32), costs.fixed32_unlike),
            (Parameter::Preparation, costs.preparation),
            (Parameter::Comparison, costs.comparison),
        ];
        let in_f64 = |(parameter, value)| (parameter, f64::from(value));
        let costs = prices.chain(others).map(in_f64);
        let budgets = [
            (Parameter::FrameBudget, budget.frame),
            (Parameter::PlanningBudget, budget.planning),
        ]
        .map(in_f64);

        // Check in this order; the error names the first value that is refused.
        let shown = [
            (Parameter::Tolerance, self.tolerance),
            (Parameter::Duration, self.duration),
        ];
        let rate = [(Parameter::Rate, f64::from(self.rate))];
        let all = shown.into_iter().chain(rate).chain(costs).chain(budgets);
        for (parameter, value) in all {
            if !value.is_finite() {
                return Err(Error::NotFinite { parameter, value });
            }
            if value <= 0.0 {
                return Err(Error::NotPositive { parameter, value });
            }
        }

        // The number of frames must fit a `u32`.
        let parameter = Parameter::Duration;
        let value = self.duration;
        let limit = f64::from(u32::MAX) / f64::from(self.rate);
        if value > limit {
            Err(Error::TooLarge {
                parameter,
                value,
                limit,
            })
        } else {
            Ok(())
        }
    }

    /// Returns the number of frames after the one at the start: the duration times the rate,
    /// rounded to the nearest integer (half to even). It is limited to the range from 1 to
    /// 2^32 - 1; a NaN gives 1.
    #[doc(hidden)] // For the firmware's budgets, and for proofs.
    #[must_use]
    pub fn frames(&self) -> u32 {
        let frames = libm::rint(self.duration * f64::from(self.rate)) as u32;
        if frames == 0 { 1 } else { frames }
    }

    /// Returns the time of frame `frame` since the start, s. Frame 0 is the start. A rate of 0
    /// gives infinity, or NaN for frame 0.
    pub(super) fn time(&self, frame: u32) -> f64 {
        f64::from(frame) / f64::from(self.rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A motion may have up to 2^32 - 1 frames: at one frame per second it may take as many
    /// seconds, but not one more.
    #[test]
    fn longest_motion_has_all_frames_that_a_u32_can_count() {
        let most = f64::from(u32::MAX);
        let check = |duration| {
            let problem = Problem {
                pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
                start: Motion::at_rest(0.0, 0.0),
                tolerance: 0.1,
                duration,
                rate: 1,
            };
            let budget = Budget {
                frame: 1.0,
                planning: 1.0,
            };
            problem.check(&Costs::CORTEX_M3, &budget)
        };
        assert_eq!(check(most), Ok(()));
        let too_large = Error::TooLarge {
            parameter: Parameter::Duration,
            value: most + 1.0,
            limit: most,
        };
        assert_eq!(check(most + 1.0), Err(too_large));
    }
}
