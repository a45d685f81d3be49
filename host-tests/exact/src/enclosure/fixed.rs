//! Balls in fixed point: a midpoint with 116 bits after the point and 8 before it, and the largest
//! distance of the true number from it. They are also discs of the complex plane about a real
//! number: every bound here holds for both.

const FRACTION: u32 = 116;
/// The limit of midpoints. Smaller ones cannot overflow a sum of [`MOST_TERMS`] products.
const LIMIT: i128 = 1 << 124;
/// The largest number of terms in a sum of products. The result of a longer one is unknown.
pub const MOST_TERMS: usize = 48;
/// 2^-116, the unit of the last place.
pub const ULP: f64 = 1.0 / (1_u128 << FRACTION) as f64;

/// Returns a number that is no less than the sum of products of numbers >= 0 that `f64` computed as
/// `value` in fewer than 2^20 operations.
///
/// Each operation may have reduced it by a factor of 1 - u, u = 2^-53: (1 - u)^(2^20 + 2) (1 +
/// 2^-32) > 1 (N. Higham, Accuracy and Stability of Numerical Algorithms, 2002, lemma 3.1). The
/// products lost less than 2^20 2^-1074 below the normal numbers.
pub fn up(value: f64) -> f64 {
    value * (1.0 + 1.0 / (1_u64 << 32) as f64) + f64::MIN_POSITIVE
}

/// A ball: all numbers within `radius` units of the last place of `middle`, which is in the same
/// units. A result whose midpoint leaves the range, -256 to 256, is unknown: its radius is
/// infinite, and so are the radii of all results from it. `+`, `-` and `*` give a ball that
/// contains the result for every two numbers in the balls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed {
    middle: i128,
    radius: f64,
}

impl Fixed {
    pub const ZERO: Self = Self {
        middle: 0,
        radius: 0.0,
    };
    pub const ONE: Self = Self {
        middle: 1 << FRACTION,
        radius: 0.0,
    };
    pub const PI: Self = Self {
        middle: 0x32_43F6_A888_5A30_8D31_3198_A2E0_3707,
        radius: 1.0,
    };

    fn new(middle: i128, radius: f64) -> Self {
        let is_known = middle.abs() < LIMIT && radius < f64::INFINITY;

        if is_known {
            Self {
                middle,
                radius: up(radius),
            }
        } else {
            Self {
                middle: 0,
                radius: f64::INFINITY,
            }
        }
    }

    pub fn of(number: f64) -> Self {
        let scaled = number / ULP;
        let middle = if scaled.abs() < LIMIT as f64 {
            scaled as i128
        } else {
            LIMIT
        };
        Self::new(middle, if scaled.fract() == 0.0 { 0.0 } else { 1.0 })
    }

    pub fn fraction(numerator: i64, denominator: u64, exponent: i32) -> Self {
        let above = u128::from(numerator.unsigned_abs());
        let below = u128::from(denominator);
        let Some(places) = FRACTION.checked_add_signed(exponent) else {
            return Self::new(LIMIT, 0.0);
        };
        let next = |(whole, rest): (u128, u128), _| {
            (
                (2 * whole + 2 * rest / below).min(LIMIT as u128),
                2 * rest % below,
            )
        };
        let start = (above / below, above % below);
        let (middle, rest) = (0..places).fold(start, next);
        Self::new(
            numerator.signum() as i128 * middle as i128,
            if rest == 0 { 0.0 } else { 1.0 },
        )
    }

    pub fn middle(self) -> Self {
        Self {
            radius: 0.0,
            ..self
        }
    }

    pub fn about(self) -> f64 {
        self.middle as f64 * ULP
    }

    /// Returns an upper bound of the distance of the true number from the midpoint.
    pub fn radius(self) -> f64 {
        up(self.radius * ULP)
    }

    /// Returns an upper bound of the absolute value of the numbers in the ball.
    pub fn size(self) -> f64 {
        up(self.about().abs() + self.radius())
    }

    pub fn wider(self, radius: f64) -> Self {
        Self::new(self.middle, self.radius + up(radius / ULP))
    }

    /// Returns the sign of every number in the ball; `None` if the ball may contain 0.
    ///
    /// The midpoint is compared as an `f64`, which may exceed it by 2^-53 of itself. [`up`]
    /// enlarges the radius by more than that, so the result is proved.
    pub fn is_positive(self) -> Option<bool> {
        (up(self.radius) < (self.middle as f64).abs()).then_some(self.middle > 0)
    }

    /// Returns the decimal with all known digits, but no more than `most` significant ones. It is
    /// cut, not rounded, and the last digit is accurate to two units.
    pub fn decimal(self, most: f64) -> String {
        let places = (-self.radius().log10())
            .min(most - self.about().abs().log10().floor() - 1.0)
            .max(0.0) as usize;
        let size = self.middle.unsigned_abs();
        let mask = (1 << FRACTION) - 1;
        let next = |rest: &u128| Some((rest & mask) * 10);
        let digits = std::iter::successors(next(&size), next)
            .map(|rest| char::from(b'0' + (rest >> FRACTION) as u8));
        let digits: String = digits.take(places).collect();
        format!(
            "{}{}.{digits}",
            if self.middle < 0 { "-" } else { "" },
            size >> FRACTION
        )
    }

    /// Returns a ball that contains every number of this one divided by a whole number.
    pub fn over(self, whole: u32) -> Self {
        Self::new(
            self.middle / i128::from(whole),
            self.radius / f64::from(whole) + 1.0,
        )
    }

    /// Returns a ball that contains the inverse of every number of this one.
    ///
    /// For any x about 1/b: |1/b - x| = |x| |1 - b x|/|b x|, and |b x| >= 1 - |1 - b x|. Newton's
    /// iteration makes x accurate.
    pub fn inverse(self) -> Self {
        let middle = self.middle();
        let mut inverse = Self::of(1.0 / middle.about()).middle();
        for _ in 0..2 {
            inverse = (inverse + inverse * (Self::ONE - middle * inverse)).middle();
        }

        // The error of the inverse is proved afterwards.
        let missing = (Self::ONE - self * inverse).size();
        inverse.wider(if missing < 0.5 {
            inverse.size() * missing / (1.0 - missing)
        } else {
            f64::INFINITY
        })
    }

    /// Returns coefficient k of the product of two power series, whose coefficients 0 to k are `a`
    /// and `b`.
    ///
    /// |a b - a0 b0| <= |a0| rb + ra (|b0| + rb). With a = a1 2^64 + a0 the sum of a1 b1 is exact:
    /// 48 terms up to 2^120. The terms a1 b0, a0 b1 and a0 b0 2^-64 are up to 2^124. Each of them
    /// loses less than 2^8, and the last one 2^-64 more. The total loss is less than 48 (3 2^8 + 1)
    /// 2^64, which is much less than the place rounded to.
    pub fn product(a: &[Self], b: &[Self]) -> Self {
        let mut high = 0_i128;
        let mut cross = 0_i128;
        let mut radius = 0.0;
        for (a, b) in a.iter().zip(b.iter().rev()) {
            let [(a1, a0), (b1, b0)] = [a, b].map(|x| ((x.middle >> 64) as i64, x.middle as u64));
            high += i128::from(a1) * i128::from(b1);
            let low = ((u128::from(a0) * u128::from(b0)) >> 72) as i128;
            cross += ((i128::from(a1) * i128::from(b0)) >> 8)
                + ((i128::from(b1) * i128::from(a0)) >> 8)
                + low;

            let [size_a, size_b] =
                [a1, b1].map(|x| (x.unsigned_abs() + 1) as f64 * ((1_u128 << 64) as f64 * ULP));
            radius += size_a * b.radius + a.radius * (size_b + b.radius * ULP);
        }

        let fits = a.len() <= MOST_TERMS && high.abs() < LIMIT >> (128 - FRACTION);
        let middle = if fits {
            (high << (128 - FRACTION)) + (cross >> (FRACTION - 72))
        } else {
            LIMIT
        };
        Self::new(middle, radius + 2.0)
    }
}

macro_rules! operators {
    ($($operator:ident $name:ident $result:expr;)*) => {$(
        impl std::ops::$operator for Fixed {
            type Output = Self;

            fn $name(self, other: Self) -> Self {
                $result(self, other)
            }
        }
    )*};
}

operators! {
    Add add (|a: Self, b: Self| Self::new(a.middle + b.middle, a.radius + b.radius));
    Sub sub (|a: Self, b: Self| Self::new(a.middle - b.middle, a.radius + b.radius));
    Mul mul (|a, b| Self::product(&[a], &[b]));
}
