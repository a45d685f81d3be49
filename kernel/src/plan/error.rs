//! What ends a plan, and why there is none.

use core::fmt;

use crate::error::Error;

/// What ends a horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Limit {
    /// The duration asked for: all of it is right.
    End,
    /// The growth of rounding errors in 64 bits, which finer steps do not reduce.
    Growth,
    /// The budget for a frame: finer steps or `f64` may go farther, and cost more.
    Budget,
    /// The budget for planning: it covers no later frame, or no trial in finer steps.
    Planning,
    /// The method and the step that were asked for: others may go farther ([`Search::of`](super::Search::of)).
    Method,
}

impl Limit {
    /// In words.
    #[doc(hidden)]
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Limit::End => "the end of the time asked for",
            Limit::Growth => "the growth of errors",
            Limit::Budget => "the budget for a frame",
            Limit::Planning => "the budget for planning",
            Limit::Method => "what this method can do",
        }
    }
}

/// Why there is no plan: a refused input with its value, or that no method keeps to the tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum PlanError {
    /// The pendulum or its start describes no motion, or none that `f32` can hold; or a tolerance, duration, rate, cost or budget
    /// is none.
    Refused(Error),
    /// Every input was good, but no method within the budgets meets the tolerance in any frame.
    NoMethod {
        /// What forbids finer steps.
        limit: Limit,
        /// Spent on planning.
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
                    "no method within the budgets meets the tolerance; finer steps are forbidden by {limit}"
                )
            }
        }
    }
}

impl core::error::Error for PlanError {}
