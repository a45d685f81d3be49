//! What the equations of motion need of a number: sums and products, and no division.

use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

/// Keeps a public trait to the types of this crate, so that it may get new methods.
pub trait Sealed {}

/// A number that the equations of motion can be computed in: `f32`, `f64`, or fixed point.
///
/// Rates of change, which a method sums up, may be numbers of another kind: in fixed point those of directions have more
/// room and fewer digits, and those of momenta, which are small, have more digits and less room.
pub trait Scalar:
    Sealed + Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + 'static
{
    /// The rate of change of a direction.
    type Slope: Copy + Debug + Add<Output = Self::Slope> + Sub<Output = Self::Slope> + Neg<Output = Self::Slope>;
    /// The greatest torque of gravity.
    type Gravity: Copy + Debug;
    /// The rate of change of a momentum.
    type Torque: Copy + Debug + Add<Output = Self::Torque> + Sub<Output = Self::Torque> + Neg<Output = Self::Torque>;
    /// The number nearest to `value`.
    fn from_f64(value: f64) -> Self;
    /// Twice the number: an addition, or a step of the exponent where an addition would be a call of 100 cycles and more.
    #[must_use]
    fn twice(self) -> Self;
    /// Half the number.
    #[must_use]
    fn half(self) -> Self;
    /// The product as the rate of change of a direction.
    fn slope(self, factor: Self) -> Self::Slope;
    /// The product of two rates and a direction as the rate of change of a momentum.
    fn torque(self, rate: Self, direction: Self) -> Self::Torque;
    /// The torque of gravity in a direction.
    fn weight(gravity: Self::Gravity, direction: Self) -> Self::Torque;
    /// `value`, of any size, as a whole number and the rest: [`times`](Self::times) the one and a product with the other.
    #[must_use]
    fn split(value: f64) -> (i32, Self) {
        (0, Self::from_f64(value))
    }
    /// The product with a whole number.
    #[must_use]
    fn times(self, whole: i32) -> Self {
        self * Self::from_f64(f64::from(whole))
    }
}
