//! What the recurrences want of a number.

use std::ops::{Add, Mul, Sub};

/// An enclosed number: what comes out of an operation holds every result that the true numbers may have.
pub trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// 0.
    const ZERO: Self;

    /// 1 by it; nothing is known of that if it may be 0.
    fn inverse(self) -> Self;

    /// It by a whole number.
    fn over(self, whole: u32) -> Self;

    /// Coefficient k of the product of two power series, of which `a` and `b` are the coefficients 0 to k.
    fn product(a: &[Self], b: &[Self]) -> Self {
        a.iter().zip(b.iter().rev()).fold(Self::ZERO, |sum, (&a, &b)| sum + a * b)
    }
}
