//! The direction form in floating point: RK4 and extrapolation, of one motion or of many side by side.

mod classical;
mod coefficients;
mod extrapolated;
mod form;

pub(crate) use classical::DirectionLanes;
pub(crate) use coefficients::BLOCK;
pub use extrapolated::ExtrapolationF64;
pub use form::DirectionForm;

use core::fmt::Debug;

use crate::numbers::{Real, Scalar};

/// A running sum, by which increments are added to a state. The number itself is kept elsewhere; what its additions lose is kept
/// here.
pub trait Sum<R>: Copy + Debug + PartialEq + 'static {
    /// For a sum that starts at `value`, of which the number keeps as many digits as it has.
    fn new(value: f64) -> Self;
    /// `number` + `increment`.
    fn add(&mut self, number: R, increment: R) -> R;
    /// What the number lacks.
    fn lost(&self) -> R;
}

/// Adds. Each addition rounds, and the error of n of them grows at least like sqrt(n).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plain;

impl<R: Scalar> Sum<R> for Plain {
    #[inline]
    fn new(_: f64) -> Self {
        Self
    }
    #[inline(always)]
    fn add(&mut self, number: R, increment: R) -> R {
        number + increment
    }
    #[inline(always)]
    fn lost(&self) -> R {
        R::from_f64(0.0)
    }
}

/// Carries the rounding error of each addition into the next, so that it does not grow with their number.
///
/// Three additions more for each. Source: W. Kahan, "Further remarks on reducing truncation errors", CACM 8, 1965.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensated<R>(R);

impl<R: Real> Sum<R> for Compensated<R> {
    #[inline]
    fn new(value: f64) -> Self {
        Self(R::from_f64(value - R::from_f64(value).to_f64()))
    }
    #[inline(always)]
    fn add(&mut self, number: R, increment: R) -> R {
        let wished = increment + self.0;
        let sum = number + wished;
        self.0 = wished - (sum - number);
        sum
    }
    #[inline(always)]
    fn lost(&self) -> R {
        self.0
    }
}
