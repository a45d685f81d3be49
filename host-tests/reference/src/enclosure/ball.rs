//! Balls of `f64`: a midpoint, and how far the true number may be from it. They are discs of the complex plane about a real
//! number as well: every bound here holds for both.

use std::ops::{Add, Mul, Sub};

use super::number::Number;

/// The unit roundoff u: an operation returns its exact result divided by 1 + d, |d| <= u, or, below the normal numbers, is off
/// by less than 2^-1074 (N. Higham, Accuracy and Stability of Numerical Algorithms, 2002, (2.4) and (2.5)).
const ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// No less than the sum of products of numbers >= 0 that `f64` computed as `value` in fewer than 2^12 operations.
///
/// Each may have taken a factor of 1 - u from it: (1 - 2^-53)^(2^12 + 2) (1 + 2^-40) > 1 (Higham, lemma 3.1). What products lost
/// below the normal numbers is less than 2^12 2^-1074.
pub fn up(value: f64) -> f64 {
    value * (1.0 + 1.0 / (1_u64 << 40) as f64) + f64::MIN_POSITIVE
}

/// The largest of numbers >= 0; NaN if one is.
pub fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |most, number| if number <= most || most.is_nan() { most } else { number })
}

/// All numbers within `radius` of `middle`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// The midpoint.
    pub middle: f64,
    /// Infinite or NaN where nothing is known.
    pub radius: f64,
}

impl Ball {
    /// That number alone.
    pub const fn exact(middle: f64) -> Self {
        Self { middle, radius: 0.0 }
    }

    /// All within `radius` of what `middle` is rounded from.
    pub fn about(middle: f64, radius: f64) -> Self {
        Self { middle, radius: up(radius + ROUNDOFF * middle.abs()) }
    }

    /// No number in it is larger, its sign left out.
    pub fn size(self) -> f64 {
        up(self.middle.abs() + self.radius)
    }

    /// Whether no number in it is above zero.
    pub fn is_at_most_zero(self) -> bool {
        self.middle <= -self.radius
    }

    /// Whether 0 is in it.
    pub fn holds_zero(self) -> bool {
        self.middle.abs() <= self.radius
    }

    /// Whether every number in it is above zero.
    pub fn is_above_zero(self) -> bool {
        self.middle > self.radius
    }
}

impl Add for Ball {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::about(self.middle + other.middle, self.radius + other.radius)
    }
}

impl Sub for Ball {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::about(self.middle - other.middle, self.radius + other.radius)
    }
}

/// |ab - a0 b0| <= |a0| rb + ra (|b0| + rb).
impl Mul for Ball {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let radius = self.middle.abs() * other.radius + self.radius * (other.middle.abs() + other.radius);
        Self::about(self.middle * other.middle, radius)
    }
}

impl Number for Ball {
    const ZERO: Self = Self::exact(0.0);

    /// |1/b - 1/b0| = |b - b0|/(|b| |b0|) <= rb/((|b0| - rb) |b0|).
    fn inverse(self) -> Self {
        let least = (self.middle.abs() - self.radius) * (1.0 - 4.0 * ROUNDOFF);
        let inverse = 1.0 / self.middle;
        let radius = if least > 0.0 { self.radius * inverse.abs() / least } else { f64::INFINITY };
        Self::about(inverse, radius)
    }

    fn over(self, whole: u32) -> Self {
        let whole = f64::from(whole);
        Self::about(self.middle / whole, self.radius / whole)
    }
}
