//! Balls of fixed point: 116 bits behind the point, 8 before it.

use std::ops::{Add, Mul, Shl, Shr, Sub};

use super::ball::{Ball, up};
use super::number::Number;

/// Bits behind the point.
const FRACTION: u32 = 116;
/// Every midpoint is smaller than this, so that no sum of [`MOST_TERMS`] products overflows.
const LIMIT: i128 = 1 << 124;
/// The most terms of a sum of products.
pub const MOST_TERMS: usize = 48;
/// 2^-116, the unit of the last place.
pub const ULP: f64 = 1.0 / (1_u128 << FRACTION) as f64;

/// All numbers within `radius` units of the last place of `middle` of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed {
    middle: i128,
    radius: f64,
}

impl Fixed {
    /// 1.
    pub const ONE: Self = Self { middle: 1 << FRACTION, radius: 0.0 };

    /// Nothing is known of what leaves the range.
    fn new(middle: i128, radius: f64) -> Self {
        if middle.abs() < LIMIT {
            Self { middle, radius: up(radius) }
        } else {
            Self { middle: 0, radius: f64::INFINITY }
        }
    }

    /// A number of `f64`; all its bits down to 2^-116.
    pub fn of(number: f64) -> Self {
        let scaled = number / ULP;
        let middle = if scaled.abs() < LIMIT as f64 { scaled as i128 } else { LIMIT };
        Self::new(middle, if scaled.fract() == 0.0 { 0.0 } else { 1.0 })
    }

    /// A fraction by 2^`halvings`, up to 63.
    pub fn fraction(numerator: i128, denominator: u64, halvings: u32) -> Self {
        let below = u128::from(denominator);
        let (whole, rest) = (numerator.unsigned_abs() / below, numerator.unsigned_abs() % below);
        let (upper, rest) = ((rest << 64) / below, (rest << 64) % below);
        let places = (upper << (FRACTION - 64)) | ((rest << (FRACTION - 64)) / below);
        let shift = FRACTION - halvings;
        let fits = whole.leading_zeros() > shift + 3;
        let middle = if fits { ((whole << shift) + (places >> halvings)) as i128 } else { LIMIT };
        Self::new(if numerator < 0 { -middle } else { middle }, 2.0)
    }

    /// The midpoint alone, and the radius.
    pub fn split(self) -> (Self, f64) {
        (Self { radius: 0.0, ..self }, up(self.radius * ULP))
    }

    /// With `radius` more.
    pub fn wider(self, radius: f64) -> Self {
        Self::new(self.middle, self.radius + up(radius / ULP))
    }

    /// As a ball of `f64`.
    pub fn ball(self) -> Ball {
        Ball::about(self.middle as f64 * ULP, up(self.radius * ULP))
    }

    /// Whether the midpoint is negative, and the digits of its size by 2^`doublings`, up to 12 either way, before the point and to so many
    /// `places` behind it, the rest cut off.
    pub fn digits(self, doublings: i32, places: usize) -> (bool, u128, String) {
        let behind = FRACTION.saturating_add_signed(-doublings);
        let (size, mask) = (self.middle.unsigned_abs(), (1 << behind) - 1);
        let mut rest = size & mask;
        let next = |_| {
            rest = (rest & mask) * 10;
            char::from(b'0' + (rest >> behind) as u8)
        };
        (self.middle < 0, size >> behind, (0..places).map(next).collect())
    }

    /// No less than any number at the midpoint: the upper half of its bits, and one more.
    fn bound(self) -> f64 {
        (((self.middle >> 64) as i64).unsigned_abs() + 1) as f64 * ((1_u128 << 64) as f64 * ULP)
    }
}

impl Add for Fixed {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.middle + other.middle, self.radius + other.radius)
    }
}

impl Sub for Fixed {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::new(self.middle - other.middle, self.radius + other.radius)
    }
}

impl Mul for Fixed {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self::product(&[self], &[other])
    }
}

/// By a power of two, rounded down.
impl Shr<u32> for Fixed {
    type Output = Self;

    fn shr(self, by: u32) -> Self {
        Self::new(self.middle >> by, self.radius / (1_u64 << by) as f64 + 1.0)
    }
}

impl Shl<u32> for Fixed {
    type Output = Self;

    fn shl(self, by: u32) -> Self {
        let fits = self.middle.unsigned_abs().leading_zeros() > by + 3;
        Self::new(if fits { self.middle << by } else { LIMIT }, self.radius * (1_u64 << by) as f64)
    }
}

impl Number for Fixed {
    const ZERO: Self = Self { middle: 0, radius: 0.0 };

    /// For any x about 1/b: |1/b - x| = |x| |1 - b x|/|b x|, and |b x| >= 1 - |1 - b x|. Newton's iteration makes x good.
    fn inverse(self) -> Self {
        let (middle, _) = self.split();
        let mut inverse = Self::of(1.0 / middle.ball().middle).split().0;
        for _ in 0..2 {
            inverse = (inverse + inverse * (Self::ONE - middle * inverse)).split().0;
        }
        let missing = (Self::ONE - self * inverse).ball().size();
        inverse.wider(if missing < 0.5 { inverse.bound() * missing / (1.0 - missing) } else { f64::INFINITY })
    }

    fn over(self, whole: u32) -> Self {
        Self::new(self.middle / i128::from(whole), self.radius / f64::from(whole) + 1.0)
    }

    /// With a = a1 2^64 + a0 the sum of a1 b1 is exact: 48 terms up to 2^120. Those of a1 b0, a0 b1 and a0 b0 2^-64 are up to 2^124; each
    /// loses less than 2^8 of them, and the last one 2^-64 more: in all less than 48 (3 2^8 + 1) 2^64, far less than the place rounded to.
    fn product(a: &[Self], b: &[Self]) -> Self {
        let (mut high, mut cross, mut radius) = (0_i128, 0_i128, 0.0);
        for (a, b) in a.iter().zip(b.iter().rev()) {
            let (a1, a0, b1, b0) = ((a.middle >> 64) as i64, a.middle as u64, (b.middle >> 64) as i64, b.middle as u64);
            high += i128::from(a1) * i128::from(b1);
            let low = ((u128::from(a0) * u128::from(b0)) >> 72) as i128;
            cross += ((i128::from(a1) * i128::from(b0)) >> 8) + ((i128::from(b1) * i128::from(a0)) >> 8) + low;
            radius += a.bound() * b.radius + a.radius * (b.bound() + b.radius * ULP);
        }
        let fits = a.len() <= MOST_TERMS && high.abs() < LIMIT >> (128 - FRACTION);
        let middle = if fits { (high << (128 - FRACTION)) + (cross >> (FRACTION - 72)) } else { LIMIT };
        Self::new(middle, radius + 2.0)
    }
}
