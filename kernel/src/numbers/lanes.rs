//! Numbers side by side, as many motions at once: plain arrays, of which the compiler makes the processor's vectors.

use core::array::from_fn;
use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

use crate::numbers::{Scalar, Sealed};

/// `N` numbers, on each of which every operation acts as on one alone: the same bits.
///
/// The equations of motion run on it as on any `Scalar`. Cost: on x86-64 that of one number for each 4 of `f32` (8 with AVX2,
/// 2 and 4 of `f64`) where `N` is a multiple of that, as long as all that is kept fits the registers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub struct Lanes<R, const N: usize>(pub [R; N]);

impl<R: Copy, const N: usize> Lanes<R, N> {
    /// The same number in every lane.
    #[inline(always)]
    #[must_use]
    pub fn splat(number: R) -> Self {
        Self([number; N])
    }

    #[inline(always)]
    fn each<S>(self, operation: impl Fn(R) -> S) -> Lanes<S, N> {
        Lanes(self.0.map(operation))
    }

    #[inline(always)]
    fn with<T: Copy, S>(self, other: Lanes<T, N>, operation: impl Fn(R, T) -> S) -> Lanes<S, N> {
        Lanes(from_fn(|lane| operation(self.0[lane], other.0[lane])))
    }
}

macro_rules! lane_by_lane {
    ($($Operator:ident $operator:ident),*) => {$(
        impl<R: Copy + $Operator<Output = R>, const N: usize> $Operator for Lanes<R, N> {
            type Output = Self;
            #[inline(always)]
            fn $operator(self, other: Self) -> Self {
                self.with(other, R::$operator)
            }
        }
    )*};
}

lane_by_lane!(Add add, Sub sub, Mul mul);

impl<R: Copy + Neg<Output = R>, const N: usize> Neg for Lanes<R, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(R::neg)
    }
}

impl<R, const N: usize> Sealed for Lanes<R, N> {}

impl<R: Scalar, const N: usize> Scalar for Lanes<R, N> {
    type Slope = Lanes<R::Slope, N>;
    type Gravity = Lanes<R::Gravity, N>;
    type Torque = Lanes<R::Torque, N>;
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self::splat(R::from_f64(value))
    }
    #[inline(always)]
    fn twice(self) -> Self {
        self.each(R::twice)
    }
    #[inline(always)]
    fn half(self) -> Self {
        self.each(R::half)
    }
    #[inline(always)]
    fn slope(self, factor: Self) -> Self::Slope {
        self.with(factor, R::slope)
    }
    #[inline(always)]
    fn torque(self, rate: Self, direction: Self) -> Self::Torque {
        Lanes(from_fn(|lane| self.0[lane].torque(rate.0[lane], direction.0[lane])))
    }
    #[inline(always)]
    fn weight(gravity: Self::Gravity, direction: Self) -> Self::Torque {
        gravity.with(direction, R::weight)
    }
}
