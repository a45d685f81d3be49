//! How increments are added to a state: plainly, or with the rounding error of each addition carried to the next.

use core::fmt::Debug;

use super::coefficients::third;
use crate::real::Real;
use crate::sealed::Sealed;

/// A running sum: the number itself is kept elsewhere, what its additions lose is kept here; sealed.
pub trait Sum<R: Real>: Sealed + Copy + Debug + PartialEq + 'static {
    /// Tells the kinds of sum apart in a checkpoint.
    #[doc(hidden)]
    const KIND: u64;
    /// For a sum that starts at `value`, of which the number keeps as many digits as it has.
    #[doc(hidden)]
    fn new(value: f64) -> Self;
    /// The sum of which the number lacks `lost`; none if it never lacks that.
    #[doc(hidden)]
    fn restore(lost: R) -> Option<Self>;
    /// `number` + `increment`.
    #[doc(hidden)]
    fn add(&mut self, number: R, increment: R) -> R;
    /// `number` + `increment` for a look ahead, what the number lacks included.
    #[doc(hidden)]
    fn ahead(&self, number: R, increment: R) -> R;
    /// What the number lacks.
    #[doc(hidden)]
    fn lost(&self) -> R;
    /// What k1 + 2 k2 + 2 k3 + k4 is multiplied by to be the increment of a step, as rounded: a third if slopes are for
    /// half a step, 1 if they are for a sixth.
    #[doc(hidden)]
    fn factor() -> f64;
    /// A `slope` times half a step.
    #[doc(hidden)]
    fn half_step(slope: R) -> R;
    /// A `slope` times a step.
    #[doc(hidden)]
    fn whole_step(slope: R) -> R;
    /// The increment of a step from k1 + 2 k2 + 2 k3 + k4.
    #[doc(hidden)]
    fn increment(slopes: R) -> R;
}

/// Adds. Each addition rounds, and the error of n of them grows at least like sqrt(n).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Plain;

impl Sealed for Plain {}

impl<R: Real> Sum<R> for Plain {
    const KIND: u64 = 0;
    #[inline]
    fn new(_: f64) -> Self {
        Self
    }
    #[inline]
    fn restore(lost: R) -> Option<Self> {
        (lost.bits() == 0).then_some(Self)
    }
    #[inline(always)]
    fn add(&mut self, number: R, increment: R) -> R {
        number + increment
    }
    #[inline(always)]
    fn ahead(&self, number: R, increment: R) -> R {
        number + increment
    }
    #[inline(always)]
    fn lost(&self) -> R {
        R::ZERO
    }
    #[inline(always)]
    fn factor() -> f64 {
        third::<R>().to_f64()
    }
    #[inline(always)]
    fn half_step(slope: R) -> R {
        slope
    }
    #[inline(always)]
    fn whole_step(slope: R) -> R {
        slope.twice()
    }
    #[inline(always)]
    fn increment(slopes: R) -> R {
        slopes * third()
    }
}

/// Carries the rounding error of each addition into the next, so that it does not grow with their number.
///
/// Three additions more for each. Source: W. Kahan, "Further remarks on reducing truncation errors", CACM 8, 1965.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Compensated<R>(R);

impl<R: Real> Sealed for Compensated<R> {}

impl<R: Real> Sum<R> for Compensated<R> {
    const KIND: u64 = 1;
    #[inline]
    fn new(value: f64) -> Self {
        Self(R::from_f64(value - R::from_f64(value).to_f64()))
    }
    #[inline]
    fn restore(lost: R) -> Option<Self> {
        Some(Self(lost))
    }
    #[inline(always)]
    fn add(&mut self, number: R, increment: R) -> R {
        let wished = increment + self.0;
        let sum = number + wished;
        self.0 = wished - (sum - number);
        sum
    }
    #[inline(always)]
    fn ahead(&self, number: R, increment: R) -> R {
        number + (increment + self.0)
    }
    #[inline(always)]
    fn lost(&self) -> R {
        self.0
    }
    // A product with a third is no good here: it errs by up to a quarter of its last place, by the same amount as long as
    // the increment changes little, and at fine steps that is the largest error of all.
    #[inline(always)]
    fn factor() -> f64 {
        1.0
    }
    #[inline(always)]
    fn half_step(slope: R) -> R {
        slope * R::from_f64(3.0)
    }
    #[inline(always)]
    fn whole_step(slope: R) -> R {
        slope * R::from_f64(6.0)
    }
    #[inline(always)]
    fn increment(slopes: R) -> R {
        slopes
    }
}
