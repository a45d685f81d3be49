//! What is computed in: what the equations need of a number, sums and products and no division; floating point, fixed point, many
//! of either side by side; and the sines.

pub(crate) mod fixed;
mod real;
mod sine;

pub use real::Real;

use core::array::from_fn;
use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

/// Keeps a public trait to the types of this crate, so that it may get new methods.
pub trait Sealed {}

/// A number that the equations of motion can be computed in: `f32`, `f64`, or fixed point.
///
/// Rates of change, which a method sums up, may be numbers of another kind: in fixed point those of directions have more
/// room and fewer digits, and those of momenta, which are small, have more digits and less room.
pub trait Scalar:
    Sealed
    + Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The rate of change of a direction.
    type Slope: Copy
        + Debug
        + Add<Output = Self::Slope>
        + Sub<Output = Self::Slope>
        + Neg<Output = Self::Slope>;
    /// The greatest torque of gravity.
    type Gravity: Copy + Debug;
    /// The rate of change of a momentum.
    type Torque: Copy
        + Debug
        + Add<Output = Self::Torque>
        + Sub<Output = Self::Torque>
        + Neg<Output = Self::Torque>;
    /// The number nearest to `value`.
    fn from_f64(value: f64) -> Self;
    /// Twice the number: an addition, or a step of the exponent where an addition would be a call of 100 cycles and more.
    #[inline(always)]
    fn twice(self) -> Self {
        self + self
    }
    /// Half the number.
    fn half(self) -> Self;
    /// The product as the rate of change of a direction.
    fn slope(self, factor: Self) -> Self::Slope;
    /// The product of two rates and a direction as the rate of change of a momentum.
    fn torque(self, rate: Self, direction: Self) -> Self::Torque;
    /// The torque of gravity in a direction.
    fn weight(gravity: Self::Gravity, direction: Self) -> Self::Torque;
    /// `value`, of any size, as a whole number and the rest: [`times`](Self::times) the one and a product with the other.
    fn split(value: f64) -> (i32, Self) {
        (0, Self::from_f64(value))
    }
    /// The product with a whole number.
    fn times(self, whole: i32) -> Self {
        self * Self::from_f64(f64::from(whole))
    }
}

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
        Lanes(from_fn(|lane| {
            self.0[lane].torque(rate.0[lane], direction.0[lane])
        }))
    }
    #[inline(always)]
    fn weight(gravity: Self::Gravity, direction: Self) -> Self::Torque {
        gravity.with(direction, R::weight)
    }
}
