//! The two floating-point types the kernel computes in.

use core::fmt::{Debug, Display};
use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::numbers::sine;

/// `f32` or `f64`, and no other type: the numbers of the formulas.
///
/// Every operation is IEEE 754 arithmetic or a routine in Rust that uses only such arithmetic, so
/// that a result is bit-identical on every machine, except for the bits of a NaN.
pub trait Real:
    RealOperations
    + Copy
    + Debug
    + Default
    + Display
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Into<f64>
    + 'static
{
}

impl<R: RealOperations> Real for R {}

/// Returns (sin, cos) of an angle, rad, by the kernel's own routine.
///
/// | | largest error | arithmetic | cost on a Cortex-M4F |
/// |---|---|---|---|
/// | `f32` | 9e-8 to pi, 1e-7 to 1e4 | 13 multiplies, 12 adds | about 40 cycles (estimate) |
/// | `f64` | 2 ulp | 19 multiplies, 21 adds | 40 calls of soft float |
///
/// The errors of `f32` are absolute, for magnitudes of the angle up to pi and up to 1e4 rad (test
/// `trigonometry`). The error of `f64` is relative, up to 1,647,098 rad.
///
/// An `f32` beyond 12,867 is computed as an `f64` and rounded. An `f64` beyond 1,647,098 is first
/// reduced by turns of the `f64` nearest to 2 pi, which changes the angle by less than half a unit
/// in its last place. For infinity and NaN both results are NaN.
#[must_use]
pub fn sin_cos<R: Real>(angle: R) -> (R, R) {
    angle.own_sin_cos()
}

/// The operations that the formulas need.
///
/// No other crate can name this trait, so that [`Real`] is sealed and may get new operations.
pub trait RealOperations:
    Copy
    + Debug
    + Default
    + Display
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Into<f64>
    + 'static
{
    const ZERO: Self;
    const ONE: Self;
    const TWO: Self;
    const HALF: Self;
    const PI: Self;
    const EPSILON: Self;

    fn from_f64(value: f64) -> Self;
    fn to_f64(self) -> f64;
    /// Returns `whole`/2^`halvings`, rounded once. `halvings` is at most 64.
    ///
    /// The exponent is changed, because a product costs more in software.
    fn fraction(whole: i64, halvings: u32) -> Self;
    fn cast<S: Real>(self) -> S {
        S::from_f64(self.to_f64())
    }
    #[must_use]
    fn abs(self) -> Self;
    /// Returns twice the number. If an addition is a call of a library, the exponent is increased
    /// instead.
    #[must_use]
    fn twice(self) -> Self;
    /// Returns a word with the sign of the number in its highest bit. The fraction of an `f64` is
    /// cut to 20 bits.
    fn side(self) -> i32;
    /// Returns the number whose [`side`](Self::side) is this word.
    fn from_side(side: i32) -> Self;
    #[must_use]
    fn sqrt(self) -> Self;
    /// The IEEE 754 format; the upper half is 0 for an `f32`.
    fn bits(self) -> u64;
    fn is_finite(self) -> bool;
    /// Returns true if the number has its full relative precision.
    fn is_normal(self) -> bool;
    #[must_use]
    fn atan2(self, x: Self) -> Self;
    fn own_sin_cos(self) -> (Self, Self);
}

/// Defines a function that returns `x` + `x` with the same bits, computed by integers.
macro_rules! twice_by_bits {
    ($name:ident, $float:ident) => {
        fn $name(x: $float) -> $float {
            const PLACE: u32 = $float::MANTISSA_DIGITS - 1;
            const LARGEST: u32 = 2 * $float::MAX_EXP as u32 - 3;
            let bits = x.to_bits();
            let exponent = (bits << 1 >> (PLACE + 1)) as u32;
            // Not inlined, because the compiler would compute the sum in any case.
            #[cold]
            fn sum(x: $float) -> $float {
                x + x
            }

            if exponent.wrapping_sub(1) < LARGEST {
                $float::from_bits(bits + (1 << PLACE))
            } else {
                sum(x)
            }
        }
    };
}

twice_by_bits!(twice_single, f32);
twice_by_bits!(twice_double, f64);

macro_rules! real {
    (
        $float:ident, $twice:ident in software if $software:meta,
        $bits:ident, $side:expr, $from_side:expr, $sqrt:path, $atan2:path, $own:ident
    ) => {
        impl RealOperations for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const HALF: Self = 0.5;
            const PI: Self = core::$float::consts::PI;
            const EPSILON: Self = $float::EPSILON;

            fn from_f64(value: f64) -> Self {
                value as $float
            }
            fn twice(self) -> Self {
                if cfg!($software) {
                    $twice(self)
                } else {
                    self + self
                }
            }
            #[inline(always)] // With `turns_over`: maps of flips take 2.5 times as long without.
            fn side(self) -> i32 {
                $side(self)
            }
            fn from_side(side: i32) -> Self {
                $from_side(side)
            }
            fn to_f64(self) -> f64 {
                self as f64
            }
            fn fraction(whole: i64, halvings: u32) -> Self {
                let halving = $float::to_bits(1.0) - $float::to_bits(0.5);
                match whole as $float {
                    0.0 => 0.0,
                    whole => $float::from_bits(whole.to_bits() - halving * $bits::from(halvings)),
                }
            }
            fn abs(self) -> Self {
                $float::abs(self)
            }
            // Not inlined, because it is rarely used, and takes a kilobyte in software.
            #[inline(never)]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            fn bits(self) -> u64 {
                self.to_bits().into()
            }
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
            fn is_normal(self) -> bool {
                $float::is_normal(self)
            }
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline] // With `single`: 6.2 KB more flash on an M4F without.
            fn own_sin_cos(self) -> (Self, Self) {
                sine::$own(self)
            }
        }
    };
}

real!(
    f32, twice_single in software if all(target_arch = "arm", target_abi = "eabi"),
    u32,
    |number: f32| number.to_bits() as i32,
    |side: i32| f32::from_bits(side as u32),
    libm::sqrtf, libm::atan2f, single
);
real!(
    f64, twice_double in software
        if all(
            target_arch = "arm",
            any(target_abi = "eabi", target_os = "none"),
            not(feature = "double-fpu")
        ),
    u64,
    |number: f64| (number.to_bits() >> 32) as i32,
    |side: i32| f64::from_bits(u64::from(side as u32) << 32),
    libm::sqrt, libm::atan2, double
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twice_by_bits_is_the_sum() {
        for high in 0..=u16::MAX {
            for low in [0, 1, 0x1234, 0x7fff, 0x8000, 0xffff_u32] {
                let x = f32::from_bits(u32::from(high) << 16 | low);
                let twice = twice_single(x);
                assert!(
                    twice.to_bits() == (x + x).to_bits() || x.is_nan() && twice.is_nan(),
                    "{x:e}"
                );

                let x =
                    f64::from_bits(u64::from(high) << 48 | u64::from(low) << 32 | u64::from(low));
                let twice = twice_double(x);
                assert!(
                    twice.to_bits() == (x + x).to_bits() || x.is_nan() && twice.is_nan(),
                    "{x:e}"
                );
            }
        }
    }
}
