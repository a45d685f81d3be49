//! How the direction form comes by r = 1/(m + S^2).

use core::fmt::Debug;

use crate::real::Real;
use crate::ring::Ring;
use crate::sealed::Sealed;

/// A way to follow r = 1/(m + S^2) through a step; sealed.
pub trait Inverse<R: Ring>: Sealed + Copy + Debug + PartialEq + 'static {
    /// Tells the kinds of inverse apart in a checkpoint.
    #[doc(hidden)]
    const KIND: u64;
    /// r at a stage where it has fallen by `fall`, as predicted, since the start of the step, and m + S^2 is `denominator`.
    #[doc(hidden)]
    fn at_stage(start: R, fall: R, denominator: R) -> R;
    /// r at the end of the step; `last` was the one of the fourth stage.
    #[doc(hidden)]
    fn at_end(last: R, m: R, s: R) -> R;
}

/// By division at each stage.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Divided;

impl Sealed for Divided {}

impl<R: Real> Inverse<R> for Divided {
    const KIND: u64 = 0;
    #[inline(always)]
    fn at_stage(_: R, _: R, denominator: R) -> R {
        R::ONE / denominator
    }
    #[inline(always)]
    fn at_end(_: R, m: R, s: R) -> R {
        R::ONE / (m + s * s)
    }
}

/// As one more quantity of the motion, r' = -2 S S' r^2: no division at all.
///
/// The last stage's r, off by the third power of the step, is put right by one Newton step, r + r (1 - (m + S^2) r). A
/// step that changes r by a third or more makes no sense with it, nor with RK4.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Followed;

impl Sealed for Followed {}

impl<R: Ring> Inverse<R> for Followed {
    const KIND: u64 = 1;
    #[inline(always)]
    fn at_stage(start: R, fall: R, _: R) -> R {
        start - fall
    }
    #[inline(always)]
    fn at_end(last: R, m: R, s: R) -> R {
        last + last * ((R::constant(1.0) - m * last) - (s * last) * s)
    }
}
