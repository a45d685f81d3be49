//! Sources of sine and cosine, chosen by type so that one build can hold and compare several.
//!
//! | source | largest error for abs x <= pi | arithmetic | cost of a pair on a Cortex-M4F |
//! |---|---|---|---|
//! | [`Own`], `f32` | 9e-8 | 13 multiplies, 12 adds | about 40 cycles (estimate) |
//! | [`Own`], `f64` | 2 ulp | 19 multiplies, 21 adds | 40 calls of soft float |
//! | [`Libm`] | 1 ulp | `f64`, also for an `f32` | about 3,200 cycles (estimate) |
//! | `Micromath` | 1.2e-3 | `f32` | about 46 cycles (estimate) |

use crate::numbers::{Real, Sealed};

/// A source of sine and cosine for the reals `R`; sealed.
///
/// One run uses one source, on the host and on the chip alike: results agree bit for bit only within a source.
pub trait SinCos<R: Real>: Sealed + Copy + core::fmt::Debug + PartialEq + 'static {
    /// (sin `angle`, cos `angle`), `angle` in rad.
    fn sin_cos(angle: R) -> (R, R);
}

/// The kernel's own: the argument less a multiple of pi/2 (Cody-Waite reduction), then minimax polynomials.
///
/// - `f32`: absolute error at most 9e-8 for abs x <= pi, at most 1e-7 for abs x <= 1e4.
/// - `f64`: at most 2 ulp for abs x <= 1.6e6.
/// - beyond 12,867 an `f32` is taken in double precision, beyond 1,647,098 the `libm` crate answers: correct, slow.
/// - an infinite argument or a NaN gives NaN for both.
///
/// Asserted by the repository's tests; for all floats of [-pi, pi] on demand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Own;

impl Sealed for Own {}

impl<R: Real> SinCos<R> for Own {
    #[inline]
    fn sin_cos(angle: R) -> (R, R) {
        angle.own_sin_cos()
    }
}

/// The `libm` crate: a port of musl's routines, at most 1 ulp from the exact value.
///
/// Cost on a Cortex-M is high: the `f32` routine works in `f64`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Libm;

impl Sealed for Libm {}

impl<R: Real> SinCos<R> for Libm {
    #[inline]
    fn sin_cos(angle: R) -> (R, R) {
        angle.libm_sin_cos()
    }
}

/// The `micromath` crate: short, and wrong by up to 1.2e-3. Here for comparison.
#[cfg(feature = "micromath")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(hidden)]
pub struct Micromath;

#[cfg(feature = "micromath")]
impl Sealed for Micromath {}

#[cfg(feature = "micromath")]
impl SinCos<f32> for Micromath {
    #[inline]
    fn sin_cos(angle: f32) -> (f32, f32) {
        micromath::F32Ext::sin_cos(angle)
    }
}

/// The source used where none is named.
pub type DefaultTrig = Own;
