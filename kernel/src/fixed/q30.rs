//! Numbers of 32 bits: products of one instruction each where there is no floating-point unit.

use core::ops::{Add, Mul, Neg, Sub};

use super::FixedPoint;
use crate::ring::Ring;
use crate::sealed::Sealed;

/// A number below 2 in 32 bits, in steps of 2^-30.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Q30(pub i32);

/// The rate of change of a direction: below 8, in steps of 2^-28, the upper word of a product, which is rounded down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Slope(pub i32);

/// The rate of change of a momentum: below 8, a whole product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Torque(pub i64);

/// The word that holds a number. That it does is what [`Motion`](super::Scaling) proves; unit tests are stopped if not.
#[inline(always)]
fn word(number: i64) -> i32 {
    #[cfg(test)]
    assert!(i32::try_from(number).is_ok(), "{number:#x} does not fit");
    number as i32
}

macro_rules! sums {
    ($type:ident) => {
        impl Add for $type {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(word(i64::from(self.0) + i64::from(other.0)))
            }
        }
        impl Neg for $type {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(word(-i64::from(self.0)))
            }
        }
        impl Sub for $type {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(word(i64::from(self.0) - i64::from(other.0)))
            }
        }
    };
}

sums!(Q30);
sums!(Slope);

impl Q30 {
    /// The product times 2^`by`, rounded to nearest.
    #[inline(always)]
    fn product(self, factor: Self, by: u32) -> Self {
        let product = i64::from(self.0) * i64::from(factor.0);
        Self(word((product + (1 << 29 >> by)) >> (30 - by)))
    }
}

impl Mul for Q30 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: Self) -> Self {
        self.product(factor, 0)
    }
}

/// Unit tests are stopped where a sum of torques does not fit.
#[inline(always)]
fn fits((sum, overflown): (i64, bool)) -> Torque {
    #[cfg(test)]
    assert!(!overflown, "a torque does not fit");
    let _ = overflown;
    Torque(sum)
}

impl Add for Torque {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        fits(self.0.overflowing_add(other.0))
    }
}

impl Sub for Torque {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        fits(self.0.overflowing_sub(other.0))
    }
}

impl Neg for Torque {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        fits(self.0.overflowing_neg())
    }
}

impl Sealed for Q30 {}

impl Ring for Q30 {
    type Slope = Slope;
    type Torque = Torque;
    #[inline(never)]
    fn constant(value: f64) -> Self {
        Self(word(libm::rint(value * f64::from(1 << 30)) as i64))
    }
    #[inline(always)]
    fn twice(self) -> Self {
        self + self
    }
    #[inline(always)]
    fn half(self) -> Self {
        Self(self.0 >> 1)
    }
    #[inline(always)]
    fn slope(self, factor: Self) -> Slope {
        Slope(word((i64::from(self.0) * i64::from(factor.0)) >> 32))
    }
    #[inline(always)]
    fn torque(self, factor: Self) -> Torque {
        Torque(i64::from(self.0) * i64::from(factor.0))
    }
}

impl FixedPoint for Q30 {
    #[inline(always)]
    fn down(self, by: u32) -> Self {
        Self(self.0 >> by)
    }
    #[inline(always)]
    fn up(self, by: u32) -> Self {
        Self(word(i64::from(self.0) << by))
    }
    #[inline(always)]
    fn torque_down(torque: Torque, by: u32) -> Torque {
        Torque(torque.0 >> by)
    }
    #[inline(always)]
    fn product_up(self, factor: Self, by: u32) -> Self {
        self.product(factor, by)
    }
}
