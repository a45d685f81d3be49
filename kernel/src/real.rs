//! The two floating-point types the kernel computes in.

use core::fmt::{Debug, Display};
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use crate::trig;

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// `f32` or `f64`, and no other type: the few operations the formulas need, one row each.
///
/// Every operation is either IEEE 754 arithmetic or a pure-Rust routine built on it, so that a result is the same
/// to the bit on every machine.
pub trait Real:
    sealed::Sealed
    + Copy
    + Default
    + PartialOrd
    + Debug
    + Display
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + 'static
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// 1/2.
    const HALF: Self;
    /// pi, rounded to nearest.
    const PI: Self;
    /// The distance from 1 to the next larger number.
    const EPSILON: Self;

    /// The number nearest to `value`.
    fn of(value: f64) -> Self;
    /// The same number as an `f64`; exact.
    fn to_f64(self) -> f64;
    /// The absolute value.
    fn abs(self) -> Self;
    /// The square root, correctly rounded; NaN below 0.
    fn sqrt(self) -> Self;
    /// The bit pattern.
    fn bits(self) -> u64;
    /// Neither infinite nor NaN.
    fn is_finite(self) -> bool;
    /// Finite, not zero and not subnormal: holds its full relative precision.
    fn is_normal(self) -> bool;
    /// The angle of the point (`x`, `self`) from the positive x axis, rad, in [-pi, pi]; by the `libm` crate.
    fn atan2(self, x: Self) -> Self;
    /// Sine and cosine by the `libm` crate.
    fn libm_sin_cos(self) -> (Self, Self);
    /// Sine and cosine by the kernel's own routine.
    fn own_sin_cos(self) -> (Self, Self);
    /// (tan(`self`/2), sin `self`) where abs `self` <= 0.09, by short polynomials.
    fn small_turn(self) -> (Self, Self);
    /// The nearest whole number; the nearest `i32` if there is none, 0 for NaN.
    fn nearest(self) -> i32;
    /// Marks k pi/32 + offset in the first eighth of the circle: (offset, sin, cos).
    const MARKS: [[Self; 3]; 9];
    /// pi/2 in three parts; whole multiples of the first two are exact.
    const PI_OVER_TWO: [Self; 3];
}

macro_rules! real {
    ($float:ident, $rint:path, $sqrt:path, $atan2:path, $sin_cos:path, $own:ident) => {
        impl Real for $float {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const HALF: Self = 0.5;
            const PI: Self = core::$float::consts::PI;
            const EPSILON: Self = $float::EPSILON;

            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline(always)]
            fn bits(self) -> u64 {
                self.to_bits().into()
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
            #[inline(always)]
            fn is_normal(self) -> bool {
                $float::is_normal(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline]
            fn libm_sin_cos(self) -> (Self, Self) {
                $sin_cos(self)
            }
            #[inline]
            fn own_sin_cos(self) -> (Self, Self) {
                trig::$own::sin_cos(self)
            }
            #[inline(always)]
            fn small_turn(self) -> (Self, Self) {
                trig::$own::small_turn(self)
            }
            #[inline]
            fn nearest(self) -> i32 {
                $rint(self) as i32
            }
            const MARKS: [[Self; 3]; 9] = trig::$own::MARKS;
            const PI_OVER_TWO: [Self; 3] = trig::$own::PI_OVER_TWO;
        }
    };
}

real!(f32, libm::rintf, libm::sqrtf, libm::atan2f, libm::sincosf, own_f32);
real!(f64, libm::rint, libm::sqrt, libm::atan2, libm::sincos, own_f64);
