//! Fractions of 64 bits: more digits than an `f64`, and much faster where `f64` is software.
//!
//! A `Q64` is from -1/2 to below 1/2, in multiples of 2^-64. A number of 1/2 - 2^-33 or more is too
//! large for `*`, `times_word` and `down`: the units of a motion keep all numbers below.

use core::ops::Mul;

use super::{nearest, product};
use crate::numbers::Real;

fixed_point! {
    /// A sum that does not fit wraps. The caller checks the range with [`reach`](Self::reach).
    Q64(i64), wrapped(i128)
}

fn wrapped(sum: i128) -> i64 {
    sum as i64
}

const UNIT: f64 = 18_446_744_073_709_551_616.0;

impl Q64 {
    pub fn value<R: Real>(self) -> R {
        self.doubled(0)
    }

    /// Returns the number times 2^`times`, rounded once. `times` is at most 64.
    pub fn doubled<R: Real>(self, times: u32) -> R {
        R::fraction(self.0, 64 - times)
    }

    /// Returns the upper word, rounded to nearest, and the lower one as a signed number.
    fn words(self) -> [i32; 2] {
        let lower = self.0 as i32;
        [
            ((self.0 >> 32) as i32).wrapping_add((lower as u32 >> 31) as i32),
            lower,
        ]
    }

    #[inline]
    pub fn times_word(self, factor: i32) -> Self {
        let [upper, lower] = self.words();
        Self(product(upper, factor) + (product(lower, factor) >> 32))
    }

    /// Returns zero if the number is from -2^-`places` to below 2^-`places`, so that the results of
    /// many checks can be joined by `|`.
    pub fn reach(self, places: u32) -> u32 {
        (((self.0 >> 32) as u32).wrapping_add(1 << (32 - places))) >> (33 - places)
    }

    /// Returns 1/(4 d), where d = 2^6 `self` is from 1 to 8, with a relative error of at most
    /// 2^-55.
    ///
    /// A quotient of words is improved by one step of Newton's method and one of third order.
    pub fn inverse(self) -> Self {
        let divisor = self.0 as u64;
        let upper = (divisor >> 32) as u32;

        // The quotient 2^44/upper, and its error (1 - upper quotient 2^-44) 2^44.
        let quotient = u32::MAX / (upper >> 12 | 1);
        let residue = upper.wrapping_mul(quotient).wrapping_neg() as i32;
        // Newton's method gives 2^88/divisor in a word.
        let correction = ((i64::from(quotient as i32) * i64::from(residue)) >> 32) as i32;
        let word = ((quotient << 12) as i32).wrapping_add(correction);

        // Its error in 32 bits, (1 - divisor word 2^-88) 2^56. Only the lowest bits of the product
        // are needed.
        let product = u64::from(divisor as u32)
            .wrapping_mul(u64::from(word as u32))
            .wrapping_add(u64::from(upper.wrapping_mul(word as u32)) << 32);
        let [residue, _] = Self(product.wrapping_neg() as i64).words();

        // The step of third order.
        let square = ((i64::from(residue) * i64::from(residue)) >> 56) as i32;
        let correction = i64::from(word) * i64::from(residue.wrapping_add(square));
        Self((i64::from(word) << 32).wrapping_add(correction >> 24))
    }
}

/// Returns the product, rounded down: from 1.25 below to 0.25 above the exact one, in units of the
/// last digit.
///
/// The product of the lower words is left out. It is negative as often as positive, and below 1/4
/// of the last digit.
impl Mul for Q64 {
    type Output = Self;
    #[inline]
    fn mul(self, factor: Self) -> Self {
        let [a, a_lower] = self.words();
        let [b, b_lower] = factor.words();
        Self(product(a, b) + (product(a, b_lower).wrapping_add(product(a_lower, b)) >> 32))
    }
}

impl Q64 {
    #[inline(never)] // With `nearest`: 3.9 KB more flash on an M4F without.
    pub fn from_f64(value: f64) -> Self {
        Self(nearest(value * UNIT) as i64)
    }

    pub fn half(self) -> Self {
        Self(self.0 >> 1)
    }

    pub fn times(self, whole: i32) -> Self {
        Self(self.0.wrapping_mul(i64::from(whole)))
    }

    pub fn down(self, by: u32) -> Self {
        Self(self.0.wrapping_add(i64::from(1_u32 << by >> 1)) >> by)
    }

    /// Returns the number times 2^`by`, moved to the middle of the values that it may have had
    /// before it was rounded down, so that no bias is left.
    pub fn up(self, by: u32) -> Self {
        Self(self.0 << by | 1 << (by - 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_are_exact_to_the_last_digit() {
        let numbers = (0..64).flat_map(|bits| {
            [1, -1, 3, -5, 0x1234_5678_9abc_def1, -0x0fed_cba9_8765_4321].map(|x: i64| x >> bits)
        });
        let numbers = numbers.chain([i64::MIN, 1 - (1 << 62), 1 << 62, i64::MAX / 3]);
        for a in numbers.clone() {
            for b in numbers.clone() {
                let exact = (i128::from(a) * i128::from(b)) as f64 / UNIT;
                // Rounding down takes 1, and the lower words 1/4.
                let error = (Q64(a) * Q64(b)).0 as f64 - exact;
                assert!(
                    (-1.25..=0.25).contains(&error) || error.abs() < exact.abs() * 1e-15,
                    "{a:#x} {b:#x}: {error}"
                );

                let word = (b >> 32) as i32;
                let exact = (i128::from(a) * i128::from(word)) >> 32;
                assert_eq!(
                    i128::from(Q64(a).times_word(word).0),
                    exact,
                    "{a:#x} {word:#x}"
                );
            }
        }
    }

    /// The tolerance is mostly for the roundings of the test, which computes in `f64`.
    #[test]
    fn inverses_are_within_two_ulp() {
        let mut d = 1.0;
        while d < 8.0 {
            let inverse = Q64::from_f64(d / 64.0).inverse().value::<f64>() * 4.0;
            assert!(
                (inverse * d - 1.0).abs() <= 0.6 * f64::EPSILON * 2.0,
                "{d}: {inverse:e}"
            );
            d *= 1.000_123;
        }
    }
}
