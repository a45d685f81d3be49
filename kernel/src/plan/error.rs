//! The limits of a plan, and the reasons why planning may fail.

use core::fmt;

use crate::error::Error;

/// The reason why a horizon is not longer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Limit {
    /// The duration of the problem: all its frames are accurate.
    End,
    /// The growth of rounding errors in 64 bits, which finer steps do not reduce.
    Growth,
    /// The frame budget. Finer steps or 64 bits may be accurate for longer, but cost more.
    ///
    /// Also the limit if 64 bits refuse the motion and finer steps in 32 bits do not help.
    Budget,
    /// The planning budget. It pays for no further frame, or for no finer steps of the reference.
    /// Later frames may be accurate.
    Planning,
    /// The method and step count, which are fixed ([`Search::of`](super::Search::of) and
    /// [`Search::extend`](super::Search::extend)). Others may have a longer horizon.
    Method,
}

impl Limit {
    /// Returns the limit in words for a message, such as `the budget for planning`.
    #[doc(hidden)] // For the firmware's log, which has no `Display`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Limit::End => "the requested duration",
            Limit::Growth => "the growth of errors",
            Limit::Budget => "the budget for a frame",
            Limit::Planning => "the budget for planning",
            Limit::Method => "the method itself",
        }
    }
}

/// The reason why there is no plan.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum PlanError {
    /// An input is refused; the error contains its value.
    ///
    /// The pendulum or its start is invalid or out of the range of `f32`, or a tolerance, duration,
    /// rate, cost or budget is not finite or not positive, or there are 2^32 frames or more, or the
    /// method fixed by the caller is not in [`Method::DRAWN`](crate::Method::DRAWN).
    Refused(Error),
    /// No method within the budgets has an accurate frame. All inputs are valid.
    NoMethod {
        /// The limit that forbids finer steps, usually the budget to raise.
        limit: Limit,
        /// The cost of planning, in the unit of the [`Costs`](super::Costs).
        spent: f32,
    },
}

impl From<Error> for PlanError {
    fn from(error: Error) -> Self {
        PlanError::Refused(error)
    }
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PlanError::Refused(error) => error.fmt(f),
            PlanError::NoMethod { limit, .. } => {
                let limit = limit.name();
                write!(
                    f,
                    "no method within the budgets meets the tolerance; \
                     finer steps are ruled out by {limit}"
                )
            }
        }
    }
}

impl core::error::Error for PlanError {}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use super::*;
    use crate::error::Parameter;

    /// A refused input displays the error of that input. [`PlanError::NoMethod`] displays a message
    /// that names the limit.
    #[test]
    fn plan_errors_display_their_reason() {
        let error = Error::NotPositive {
            parameter: Parameter::L1,
            value: 0.0,
        };
        assert_eq!(PlanError::from(error).to_string(), error.to_string());

        let error = PlanError::NoMethod {
            limit: Limit::Planning,
            spent: 1.0,
        };
        assert_eq!(
            error.to_string(),
            "no method within the budgets meets the tolerance; \
             finer steps are ruled out by the budget for planning"
        );
    }
}
