//! Numbers with their derivatives after the start.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

use super::ball::Ball;
use super::number::Number;

/// A number, and its derivatives after six others.
#[derive(Clone, Copy, Debug)]
pub struct Tangents(pub Ball, pub [Ball; 6]);

impl Tangents {
    /// What depends on none of the six.
    pub fn constant(value: Ball) -> Self {
        Self(value, [Ball::ZERO; 6])
    }

    /// The six themselves.
    pub fn variables(values: &[Ball; 6]) -> [Self; 6] {
        from_fn(|i| Self(values[i], from_fn(|j| Ball::exact(if i == j { 1.0 } else { 0.0 }))))
    }
}

impl Add for Tangents {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0, from_fn(|i| self.1[i] + other.1[i]))
    }
}

impl Sub for Tangents {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0, from_fn(|i| self.1[i] - other.1[i]))
    }
}

/// (ab)' = a' b + a b'.
#[expect(clippy::suspicious_arithmetic_impl, reason = "the rule has a sum")]
impl Mul for Tangents {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0, from_fn(|i| self.1[i] * other.0 + self.0 * other.1[i]))
    }
}

impl Number for Tangents {
    const ZERO: Self = Self(Ball::ZERO, [Ball::ZERO; 6]);

    /// (1/b)' = -b'/b^2.
    fn inverse(self) -> Self {
        let inverse = self.0.inverse();
        Self(inverse, self.1.map(|slope| Ball::ZERO - slope * inverse * inverse))
    }

    fn over(self, whole: u32) -> Self {
        Self(self.0.over(whole), self.1.map(|slope| slope.over(whole)))
    }
}
