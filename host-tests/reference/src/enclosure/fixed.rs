//! Balls of fixed point: 116 bits behind the point, 8 before it, and how far the true number may be from that. They are discs of the
//! complex plane about a real number as well: every bound here holds for both.

/// Bits behind the point.
const FRACTION: u32 = 116;
/// Every midpoint is smaller than this, so that no sum of [`MOST_TERMS`] products overflows.
const LIMIT: i128 = 1 << 124;
/// The most terms of a sum of products.
pub const MOST_TERMS: usize = 48;
/// 2^-116, the unit of the last place.
pub const ULP: f64 = 1.0 / (1_u128 << FRACTION) as f64;

/// No less than the sum of products of numbers >= 0 that `f64` computed as `value` in fewer than 2^20 operations.
///
/// Each may have taken a factor of 1 - u from it, u = 2^-53: (1 - u)^(2^20 + 2) (1 + 2^-32) > 1 (N. Higham, Accuracy and Stability of
/// Numerical Algorithms, 2002, lemma 3.1). What products lost below the normal numbers is less than 2^20 2^-1074.
pub fn up(value: f64) -> f64 {
    value * (1.0 + 1.0 / (1_u64 << 32) as f64) + f64::MIN_POSITIVE
}

/// All numbers within `radius` units of the last place of `middle` of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed {
    middle: i128,
    radius: f64,
}

impl Fixed {
    /// 0.
    pub const ZERO: Self = Self {
        middle: 0,
        radius: 0.0,
    };
    /// 1.
    pub const ONE: Self = Self {
        middle: 1 << FRACTION,
        radius: 0.0,
    };
    /// pi, cut after 116 bits.
    pub const PI: Self = Self {
        middle: 0x32_43F6_A888_5A30_8D31_3198_A2E0_3707,
        radius: 1.0,
    };

    /// Nothing is known of what leaves the range.
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

    /// A number of `f64`; all its bits down to 2^-116.
    pub fn of(number: f64) -> Self {
        let scaled = number / ULP;
        let middle = if scaled.abs() < LIMIT as f64 {
            scaled as i128
        } else {
            LIMIT
        };
        Self::new(middle, if scaled.fract() == 0.0 { 0.0 } else { 1.0 })
    }

    /// A fraction times 2^`exponent`, bit by bit.
    pub fn fraction(numerator: i64, denominator: u64, exponent: i32) -> Self {
        let (above, below) = (
            u128::from(numerator.unsigned_abs()),
            u128::from(denominator),
        );
        let Some(places) = FRACTION.checked_add_signed(exponent) else {
            return Self::new(LIMIT, 0.0);
        };
        let next = |(whole, rest): (u128, u128), _| {
            (
                (2 * whole + 2 * rest / below).min(LIMIT as u128),
                2 * rest % below,
            )
        };
        let (middle, rest) = (0..places).fold((above / below, above % below), next);
        Self::new(
            numerator.signum() as i128 * middle as i128,
            if rest == 0 { 0.0 } else { 1.0 },
        )
    }

    /// The midpoint alone.
    pub fn middle(self) -> Self {
        Self {
            radius: 0.0,
            ..self
        }
    }

    /// The `f64` next to the midpoint.
    pub fn about(self) -> f64 {
        self.middle as f64 * ULP
    }

    /// How far the true number may be from the midpoint.
    pub fn radius(self) -> f64 {
        up(self.radius * ULP)
    }

    /// No number in it is larger, its sign left out.
    pub fn size(self) -> f64 {
        up(self.about().abs() + self.radius())
    }

    /// With `radius` more.
    pub fn wider(self, radius: f64) -> Self {
        Self::new(self.middle, self.radius + up(radius / ULP))
    }

    /// Whether every number in it is above zero, or every one below; `None` if 0 may be in it. `f64` has the midpoint to 2^-53.
    pub fn is_positive(self) -> Option<bool> {
        (up(self.radius) < (self.middle as f64).abs()).then_some(self.middle > 0)
    }

    /// All digits that are known, the last one to two units; no more than `most` of them.
    pub fn decimal(self, most: f64) -> String {
        let places = (-self.radius().log10())
            .min(most - self.about().abs().log10().floor() - 1.0)
            .max(0.0) as usize;
        let (size, mask) = (self.middle.unsigned_abs(), (1 << FRACTION) - 1);
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

    /// By a whole number.
    pub fn over(self, whole: u32) -> Self {
        Self::new(
            self.middle / i128::from(whole),
            self.radius / f64::from(whole) + 1.0,
        )
    }

    /// 1 by it; nothing is known of that if it may be 0.
    ///
    /// For any x about 1/b: |1/b - x| = |x| |1 - b x|/|b x|, and |b x| >= 1 - |1 - b x|. Newton's iteration makes x good.
    pub fn inverse(self) -> Self {
        let middle = self.middle();
        let mut inverse = Self::of(1.0 / middle.about()).middle();
        for _ in 0..2 {
            inverse = (inverse + inverse * (Self::ONE - middle * inverse)).middle();
        }
        let missing = (Self::ONE - self * inverse).size();
        inverse.wider(if missing < 0.5 {
            inverse.size() * missing / (1.0 - missing)
        } else {
            f64::INFINITY
        })
    }

    /// Coefficient k of the product of two power series, of which `a` and `b` are the coefficients 0 to k.
    ///
    /// |a b - a0 b0| <= |a0| rb + ra (|b0| + rb). With a = a1 2^64 + a0 the sum of a1 b1 is exact: 48 terms up to 2^120. Those of a1 b0,
    /// a0 b1 and a0 b0 2^-64 are up to 2^124; each loses less than 2^8 of them, and the last one 2^-64 more: in all less than
    /// 48 (3 2^8 + 1) 2^64, far less than the place rounded to.
    pub fn product(a: &[Self], b: &[Self]) -> Self {
        let (mut high, mut cross, mut radius) = (0_i128, 0_i128, 0.0);
        for (a, b) in a.iter().zip(b.iter().rev()) {
            let [(a1, a0), (b1, b0)] = [a, b].map(|x| ((x.middle >> 64) as i64, x.middle as u64));
            high += i128::from(a1) * i128::from(b1);
            let low = ((u128::from(a0) * u128::from(b0)) >> 72) as i128;
            cross += ((i128::from(a1) * i128::from(b0)) >> 8)
                + ((i128::from(b1) * i128::from(a0)) >> 8)
                + low;
            // their upper halves, and one more
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
