//! Numbers as users write them: decimals (`0.25`, `1e-3`) and fractions (`1/256`), kept exact.

use std::fmt;
use std::str::FromStr;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// A finite number, exactly as written.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    text: String,
    exact: BigRational,
}

/// Why a text is not a [`Number`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NumberError {
    /// Neither a decimal nor a fraction of two.
    #[error("not a number (write a decimal or a fraction such as 1/256)")]
    NotANumber,
    /// NaN, infinite, or beyond the range of `f64`.
    #[error("must be a finite number")]
    NotFinite,
    /// A fraction with denominator zero.
    #[error("the denominator is zero")]
    ZeroDenominator,
}

impl Number {
    /// The `f64` nearest to it.
    pub fn value(&self) -> f64 {
        self.exact.to_f64().unwrap_or(f64::NAN)
    }

    /// Less than zero.
    pub fn is_negative(&self) -> bool {
        self.exact.is_negative()
    }

    /// Greater than zero.
    pub fn is_positive(&self) -> bool {
        self.exact.is_positive()
    }

    /// How many times `step` goes into it, if that is a whole number below 2^53.
    pub fn whole_multiple_of(&self, step: &Number) -> Option<u64> {
        if step.exact.is_zero() {
            return None;
        }
        let ratio = &self.exact / &step.exact;
        let count = ratio.is_integer().then(|| ratio.to_integer().to_u64())??;
        (count < 1 << f64::MANTISSA_DIGITS).then_some(count)
    }

    /// This number divided by `parts`; by 0, unchanged.
    pub fn divided_by(&self, parts: u32) -> Number {
        let exact = &self.exact / &BigRational::from(BigInt::from(parts.max(1)));
        Self { text: exact.to_string(), exact }
    }

    /// The `f64` nearest to `count` times it.
    pub fn times(&self, count: u64) -> f64 {
        (&self.exact * BigInt::from(count)).to_f64().unwrap_or(f64::NAN)
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl FromStr for Number {
    type Err = NumberError;

    fn from_str(text: &str) -> Result<Self, NumberError> {
        let exact = match text.split_once('/') {
            None => decimal(text)?,
            Some((numerator, denominator)) => {
                let denominator = decimal(denominator)?;
                if denominator.is_zero() {
                    return Err(NumberError::ZeroDenominator);
                }
                decimal(numerator)? / denominator
            }
        };
        let representable = exact.to_f64().is_some_and(f64::is_finite);
        if representable { Ok(Self { text: text.to_owned(), exact }) } else { Err(NumberError::NotFinite) }
    }
}

/// `[+-]digits[.digits][e[+-]digits]`, exactly.
fn decimal(text: &str) -> Result<BigRational, NumberError> {
    // The standard parser decides what is a decimal, and refuses what an f64 cannot hold.
    if !text.parse::<f64>().map_err(|_| NumberError::NotANumber)?.is_finite() {
        return Err(NumberError::NotFinite);
    }
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let exponent: i32 = exponent.parse().map_err(|_| NumberError::NotANumber)?;
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: BigInt = format!("{whole}{fraction}").parse().map_err(|_| NumberError::NotANumber)?;
    let places = i64::from(exponent) - fraction.len() as i64;
    match i32::try_from(places) {
        _ if digits.is_zero() => Ok(BigRational::zero()),
        // Beyond these an f64 is zero or infinite, and the power of ten would be absurdly long.
        Ok(places) if places.abs() <= 10_000 => Ok(BigRational::from(BigInt::from(10)).pow(places) * digits),
        _ => Err(NumberError::NotFinite),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Number {
        text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn decimals_and_fractions_round_once() {
        for (text, value) in [
            ("0.1", 0.1),
            ("-2.5e-3", -2.5e-3),
            (".5", 0.5),
            ("5.", 5.0),
            ("+7", 7.0),
            ("1/3", 1.0 / 3.0),
            ("1/4096", 1.0 / 4096.0),
            ("-0.1/0.3", -1.0 / 3.0),
            ("1e308", 1e308),
            ("5e-324", 5e-324),
        ] {
            assert_eq!(number(text).value(), value, "{text}");
        }
    }

    #[test]
    fn refuses_what_is_no_finite_number() {
        for (text, error) in [
            ("", NumberError::NotANumber),
            ("one", NumberError::NotANumber),
            ("1/2/3", NumberError::NotANumber),
            ("nan", NumberError::NotFinite),
            ("-inf", NumberError::NotFinite),
            ("1e999", NumberError::NotFinite),
            ("1/1e-320/", NumberError::NotANumber),
            ("1e300/1e-300", NumberError::NotFinite),
            ("1/0", NumberError::ZeroDenominator),
        ] {
            assert_eq!(text.parse::<Number>(), Err(error), "{text}");
        }
    }

    #[test]
    fn multiples_are_exact() {
        assert_eq!(number("10").whole_multiple_of(&number("0.1")), Some(100));
        assert_eq!(number("5").whole_multiple_of(&number("1/4096")), Some(20480));
        assert_eq!(number("1").whole_multiple_of(&number("1/3")), Some(3));
        assert_eq!(number("1").whole_multiple_of(&number("0.3")), None);
        assert_eq!(number("-1").whole_multiple_of(&number("0.5")), None);
        assert_eq!(number("1").whole_multiple_of(&number("0")), None);
        assert_eq!(number("0.1").times(3), 0.3);
    }

    #[test]
    fn parts_are_exact() {
        let part = number("0.1").divided_by(3);
        assert_eq!(part.to_string(), "1/30");
        assert_eq!(number("0.1").whole_multiple_of(&part), Some(3));
    }
}
