//! Power series in time, coefficient by coefficient.

use std::ops::{Add, Div, Index, IndexMut, Mul, Neg, Sub};

use twofloat::TwoFloat;
use twofloat::consts::FRAC_PI_2;

/// The highest power that any number keeps.
const MOST: usize = <TwoFloat as Scalar>::ORDER;

/// A number that a series is made of.
pub trait Scalar:
    Copy
    + PartialOrd
    + From<f64>
    + Into<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// The highest power kept.
    const ORDER: usize;
    /// The least term of a series kept, relative to the rates of the motion: the resolution of the arithmetic.
    const RESOLUTION: f64;

    /// The quotient, to full precision.
    fn over(self, divisor: Self) -> Self;

    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
}

/// About 30 digits.
impl Scalar for TwoFloat {
    const ORDER: usize = 36;
    const RESOLUTION: f64 = 1e-33;

    fn over(self, divisor: Self) -> Self {
        divide(self, divisor)
    }

    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }
}

/// About 15 digits, in a fiftieth of the time.
impl Scalar for f64 {
    const ORDER: usize = 20;
    const RESOLUTION: f64 = 1e-17;

    fn over(self, divisor: Self) -> Self {
        self / divisor
    }

    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
}

/// sum of c_k h^k for k = 0..=[`ORDER`](Scalar::ORDER).
#[derive(Clone, Debug)]
pub struct Series<T>([T; MOST + 1]);

impl<T: Scalar> Default for Series<T> {
    fn default() -> Self {
        Self([T::from(0.0); MOST + 1])
    }
}

impl<T> Index<usize> for Series<T> {
    type Output = T;

    fn index(&self, k: usize) -> &T {
        &self.0[k]
    }
}

impl<T> IndexMut<usize> for Series<T> {
    fn index_mut(&mut self, k: usize) -> &mut T {
        &mut self.0[k]
    }
}

impl<T: Scalar> Series<T> {
    /// The series of which only the value is known.
    pub fn new(value: T) -> Self {
        let mut series = Self::default();
        series[0] = value;
        series
    }

    /// Coefficient `k` of the product with `other`.
    pub fn product(&self, other: &Self, k: usize) -> T {
        (0..=k).fold(T::from(0.0), |sum, j| sum + self[j] * other[k - j])
    }

    /// Coefficient `k` of this series, whose earlier ones are known and which is n/d: `numerator` is n's coefficient `k`.
    pub fn quotient(&self, numerator: T, d: &Self, k: usize) -> T {
        (1..=k).fold(numerator, |rest, j| rest - d[j] * self[k - j]).over(d[0])
    }

    /// The sum at `h`.
    pub fn at(&self, h: T) -> T {
        self.0[..=T::ORDER].iter().rev().fold(T::from(0.0), |sum, &c| sum * h + c)
    }
}

/// The series of the sine and cosine of an angle that is itself a series.
#[derive(Clone, Debug)]
pub struct Wave<T> {
    /// The sine.
    pub sin: Series<T>,
    /// The cosine.
    pub cos: Series<T>,
}

impl<T: Scalar> Wave<T> {
    /// The values, from the value of `angle`.
    pub fn new(angle: &Series<T>) -> Self {
        let (sin, cos) = angle[0].sin_cos();
        Self { sin: Series::new(sin), cos: Series::new(cos) }
    }

    /// Coefficient `k`, from s' = c a' and c' = -s a'.
    pub fn extend(&mut self, angle: &Series<T>, k: usize) {
        let slope =
            |of: &Series<T>| (1..=k).fold(T::from(0.0), |sum, j| sum + angle[j] * of[k - j] * j as f64) / k as f64;
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
