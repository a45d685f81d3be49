//! Numbers of 64 bits: the digits of an `f64` at a tenth of its price where that is software.

use core::ops::{Add, Mul, Neg, Sub};

use super::FixedPoint;
use crate::ring::Ring;
use crate::sealed::Sealed;

/// A number below 8 in 64 bits, in steps of 2^-60; below 2 as a factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Q60(pub i64);

/// Both factors are split into an upper word and so many bits.
const LOW: u32 = 30;

/// Half a step, and what the product of the two lower parts, which is left out, comes to on average.
const ROUNDING: i64 = (1 << (LOW - 1)) + (1 << (LOW - 2));

impl Q60 {
    #[inline(always)]
    fn parts(self) -> [i64; 2] {
        #[cfg(test)]
        assert!(self.0.unsigned_abs() < 1 << 61, "{self:?} is too large for a factor");
        [i64::from((self.0 >> LOW) as i32), self.0 & ((1 << LOW) - 1)]
    }
}

/// Unit tests are stopped where a sum leaves the range, which [`Scaling`](super::Scaling) proves it does not.
#[inline(always)]
fn exact((sum, overflown): (i64, bool)) -> Q60 {
    #[cfg(test)]
    assert!(!overflown, "a sum leaves the range");
    let _ = overflown;
    Q60(sum)
}

impl Add for Q60 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        exact(self.0.overflowing_add(other.0))
    }
}

impl Sub for Q60 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        exact(self.0.overflowing_sub(other.0))
    }
}

impl Mul for Q60 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: Self) -> Self {
        let ([a, a_low], [b, b_low]) = (self.parts(), factor.parts());
        Self(a * b + ((a * b_low + a_low * b + ROUNDING) >> LOW))
    }
}

impl Neg for Q60 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        exact(self.0.overflowing_neg())
    }
}

impl Sealed for Q60 {}

impl Ring for Q60 {
    type Slope = Self;
    type Torque = Self;
    #[inline(never)]
    fn constant(value: f64) -> Self {
        Self(libm::rint(value * (1_u64 << 60) as f64) as i64)
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
    fn slope(self, factor: Self) -> Self {
        self * factor
    }
    #[inline(always)]
    fn torque(self, factor: Self) -> Self {
        self * factor
    }
}

impl FixedPoint for Q60 {
    #[inline(always)]
    fn down(self, by: u32) -> Self {
        Self(self.0 >> by)
    }
    #[inline(always)]
    fn up(self, by: u32) -> Self {
        Self(self.0 << by)
    }
    #[inline(always)]
    fn torque_down(torque: Self, by: u32) -> Self {
        torque.down(by)
    }
    #[inline(always)]
    fn product_up(self, factor: Self, by: u32) -> Self {
        (self * factor).up(by)
    }
}
