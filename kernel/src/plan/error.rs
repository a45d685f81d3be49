//! Why there is no plan.

use core::fmt;

use super::limit::Limit;
use crate::error::Error;

/// What a plan is asked for by, beside the pendulum and its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Quantity {
    /// How far a bob may be off, m.
    Tolerance,
    /// How long the motion is shown, s.
    Duration,
    /// Frames per second.
    Rate,
    /// What a step costs, in the unit of the budget.
    Cost,
    /// What computing a frame may cost.
    FrameBudget,
    /// What planning may cost.
    PlanningBudget,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Quantity::Tolerance => "tolerance",
            Quantity::Duration => "duration",
            Quantity::Rate => "rate",
            Quantity::Cost => "cost",
            Quantity::FrameBudget => "budget for a frame",
            Quantity::PlanningBudget => "budget for planning",
        })
    }
}

/// Why there is no plan: a refused input with its value, or that nothing holds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum PlanError {
    /// The pendulum or its start describes no motion, or none that `f32` can hold.
    Motion(Error),
    /// Must be a finite number greater than zero.
    NotPositive {
        /// The offending quantity.
        quantity: Quantity,
        /// Its value.
        value: f64,
    },
    /// Must not exceed a limit that the others set.
    TooLarge {
        /// The offending quantity.
        quantity: Quantity,
        /// Its value.
        value: f64,
        /// The greatest value allowed.
        limit: f64,
    },
    /// Every input was good, but nothing within the budgets was right in any frame.
    NothingHolds {
        /// What forbids finer steps.
        limit: Limit,
        /// Spent on planning.
        spent: f32,
    },
}

impl From<Error> for PlanError {
    fn from(error: Error) -> Self {
        PlanError::Motion(error)
    }
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PlanError::Motion(error) => error.fmt(f),
            PlanError::NotPositive { quantity, value } => {
                write!(f, "{quantity} = {value:?}: must be a finite number greater than zero")
            }
            PlanError::TooLarge { quantity, value, limit } => {
                write!(f, "{quantity} = {value:?}: must not exceed {limit:?}")
            }
            PlanError::NothingHolds { limit, .. } => {
                write!(
                    f,
                    "nothing within the budgets is right in any frame; finer steps are forbidden by {}",
                    limit.name()
                )
            }
        }
    }
}

impl core::error::Error for PlanError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            PlanError::Motion(error) => Some(error),
            _ => None,
        }
    }
}

/// Refuses the first of `values` that is not a finite number greater than zero.
#[inline(never)] // one copy
pub(super) fn check_positive(quantity: Quantity, values: &[f64]) -> Result<(), PlanError> {
    match values.iter().find(|value| !is_positive(**value)) {
        Some(&value) => Err(PlanError::NotPositive { quantity, value }),
        None => Ok(()),
    }
}

#[inline(never)] // one copy
fn is_positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}
