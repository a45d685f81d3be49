//! Numbers of 32 bits: products of one instruction each where there is no floating-point unit.

use core::ops::Mul;

use super::{nearest, product, scaled, upper};
use crate::numbers::{Scalar, Sealed};

/// The word that holds a number. That it does is what [`Scaling`](crate::methods::scaling::Scaling) sees to; unit tests are stopped if not.
#[inline(always)]
pub(crate) fn word(number: i64) -> i32 {
    #[cfg(test)]
    watch::look_at(number);
    number as i32
}

/// Looks at every number on its way into its word.
#[cfg(test)]
pub(crate) mod watch {
    use core::cell::Cell;

    std::thread_local! {
        static LARGEST: Cell<u64> = const { Cell::new(0) };
    }

    pub fn look_at(number: i64) {
        assert!(i32::try_from(number).is_ok(), "{number:#x} does not fit");
        LARGEST.set(LARGEST.get().max(number.unsigned_abs()));
    }

    /// How near to the end of its word, 1, anything came in `computation`; directions are always about half-way.
    pub fn largest(computation: impl FnOnce()) -> f64 {
        LARGEST.set(0);
        computation();
        LARGEST.get() as f64 / f64::from(1_u32 << 31)
    }
}

fixed_point! {
    /// A direction, a rate, a momentum or r: below 2, in steps of 2^-30.
    Q30(i32), word(i64)
}
fixed_point! {
    /// The rate of change of a direction: below 8, in steps of 2^-28.
    Slope(i32), word(i64)
}
fixed_point! {
    /// The greatest torque of gravity: below 1/4, in steps of 2^-33.
    Gravity(i32), word(i64)
}
fixed_point! {
    /// The rate of change of a momentum: below 1, in steps of 2^-31.
    Torque(i32), word(i64)
}

impl Gravity {
    /// Steps in 1.
    pub const STEPS: f64 = (1_u64 << 33) as f64;

    pub fn from_f64(value: f64) -> Self {
        Self(word(nearest(value * Self::STEPS) as i64))
    }

    /// What this misses of `value`.
    pub fn missed(self, value: f64) -> f64 {
        value - f64::from(self.0) / Self::STEPS
    }
}

impl Slope {
    /// The same as a number.
    #[inline(always)]
    pub fn number(self) -> Q30 {
        Q30(word(i64::from(self.0) << 2))
    }
}

/// Rounded down to a multiple of 2^-28: the upper word, shifted, which costs nothing where a sum takes its operand shifted.
impl Mul for Q30 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: Self) -> Self {
        Slope(upper(self.0, factor.0)).number()
    }
}

impl Sealed for Q30 {}

impl Scalar for Q30 {
    type Slope = Slope;
    type Gravity = Gravity;
    type Torque = Torque;
    fn from_f64(value: f64) -> Self {
        Self(word(nearest(scaled(value, 30)) as i64))
    }
    #[inline(always)]
    fn half(self) -> Self {
        Self(self.0 >> 1)
    }
    #[inline(always)]
    fn slope(self, factor: Self) -> Slope {
        Slope(upper(self.0, factor.0))
    }
    #[inline(always)]
    fn torque(self, rate: Self, direction: Self) -> Torque {
        // the force: below 1/2, in steps of 2^-32
        let force = word(i64::from(upper(self.0, rate.0)) << 4);
        Torque(word(product(force, direction.0) >> 31))
    }
    #[inline(always)]
    fn weight(gravity: Gravity, direction: Self) -> Torque {
        Torque(upper(gravity.0, direction.0))
    }
}

impl Q30 {
    #[inline(always)]
    pub fn down(self, by: u32) -> Self {
        Self(self.0 >> by)
    }
    #[inline(always)]
    pub fn up(self, by: u32) -> Self {
        Self(word(i64::from(self.0) << by))
    }
    /// The product with `factor` times 2^`by`.
    #[inline(always)]
    pub fn product_up(self, factor: Self, by: u32) -> Self {
        Self(word(product(self.0, factor.0) >> (30 - by)))
    }
}
