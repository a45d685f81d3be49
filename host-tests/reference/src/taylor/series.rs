//! Power series in time, coefficient by coefficient.

use std::ops::{Index, IndexMut};

use twofloat::TwoFloat;
use twofloat::consts::FRAC_PI_2;

/// The highest power kept.
pub const ORDER: usize = 36;

/// sum of c_k h^k for k = 0..=[`ORDER`].
#[derive(Clone, Debug)]
pub struct Series([TwoFloat; ORDER + 1]);

impl Default for Series {
    fn default() -> Self {
        Self([0.0.into(); ORDER + 1])
    }
}

impl Index<usize> for Series {
    type Output = TwoFloat;

    fn index(&self, k: usize) -> &TwoFloat {
        &self.0[k]
    }
}

impl IndexMut<usize> for Series {
    fn index_mut(&mut self, k: usize) -> &mut TwoFloat {
        &mut self.0[k]
    }
}

impl Series {
    /// The series of which only the value is known.
    pub fn new(value: TwoFloat) -> Self {
        let mut series = Self::default();
        series[0] = value;
        series
    }

    /// Coefficient `k` of the product with `other`.
    pub fn product(&self, other: &Self, k: usize) -> TwoFloat {
        (0..=k).fold(TwoFloat::from(0.0), |sum, j| sum + self[j] * other[k - j])
    }

    /// Coefficient `k` of this series, whose earlier ones are known and which is n/d: `numerator` is n's coefficient `k`.
    pub fn quotient(&self, numerator: TwoFloat, d: &Self, k: usize) -> TwoFloat {
        divide((1..=k).fold(numerator, |rest, j| rest - d[j] * self[k - j]), d[0])
    }

    /// The sum at `h`.
    pub fn at(&self, h: TwoFloat) -> TwoFloat {
        self.0.iter().rev().fold(TwoFloat::from(0.0), |sum, &c| sum * h + c)
    }
}

/// The series of the sine and cosine of an angle that is itself a series.
#[derive(Clone, Debug)]
pub struct Wave {
    /// The sine.
    pub sin: Series,
    /// The cosine.
    pub cos: Series,
}

impl Wave {
    /// The values, from the value of `angle`.
    pub fn new(angle: &Series) -> Self {
        let (sin, cos) = sin_cos(angle[0]);
        Self { sin: Series::new(sin), cos: Series::new(cos) }
    }

    /// Coefficient `k`, from s' = c a' and c' = -s a'.
    pub fn extend(&mut self, angle: &Series, k: usize) {
        let slope =
            |of: &Series| (1..=k).fold(TwoFloat::from(0.0), |sum, j| sum + angle[j] * of[k - j] * j as f64) / k as f64;
        if k > 0 {
            (self.sin[k], self.cos[k]) = (slope(&self.cos), -slope(&self.sin));
        }
    }
}

/// (sin `angle`, cos `angle`) by their own power series about the nearest multiple of pi/2.
pub fn sin_cos(angle: TwoFloat) -> (TwoFloat, TwoFloat) {
    let quarter_turns = f64::from(angle / FRAC_PI_2).round();
    let x = angle - FRAC_PI_2 * quarter_turns;
    let alternating = |first: TwoFloat, mut power: f64| {
        let (mut sum, mut term) = (first, first);
        while term.hi().abs() > 1e-36 {
            term = -(term * x * x) / ((power + 1.0) * (power + 2.0));
            sum += term;
            power += 2.0;
        }
        sum
    };
    let (sin, cos) = (alternating(x, 1.0), alternating(1.0.into(), 0.0));
    match quarter_turns.rem_euclid(4.0) as u8 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// a/b to full precision: the quotient of twofloat 0.8.4 is good to 1e-16 only, so its remainder is divided as well.
pub fn divide(a: TwoFloat, b: TwoFloat) -> TwoFloat {
    let quotient = a / b;
    quotient + (a - quotient * b) / b
}
