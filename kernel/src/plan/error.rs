//! Why there is no plan.

use core::fmt;

use super::limit::Limit;
use crate::error::{Error, Parameter};

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
                write!(f, "no method within the budgets meets the tolerance; finer steps are forbidden by {limit}")
            }
        }
    }
}

impl core::error::Error for PlanError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            PlanError::Refused(error) => Some(error),
            PlanError::NoMethod { .. } => None,
        }
    }
}

/// Refuses the first of `values` that is not a finite number greater than zero.
#[inline(never)] // never inlined, to avoid a second copy
pub(super) fn check_positive(parameter: Parameter, values: &[f64]) -> Result<(), Error> {
    match values.iter().find(|value| !value.is_finite() || **value <= 0.0) {
        Some(&value) if value.is_finite() => Err(Error::NotPositive { parameter, value }),
        Some(&value) => Err(Error::NotFinite { parameter, value }),
        None => Ok(()),
    }
}
