//! Numbers as users write them: decimals (`0.25`, `1e-3`) and fractions (`1/256`), kept exact.

use std::fmt;
use std::str::FromStr;

use crate::prove::Given;

/// A finite number as written.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    text: String,
    value: f64,
    /// `None` of one with more than 38 digits or 19 places: of that, the value alone is known.
    fraction: Option<Fraction>,
}

/// A numerator over a denominator, in lowest terms.
type Fraction = (i128, u64);

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
        self.value
    }

    /// Itself, if it has at most 38 digits and 19 places.
    pub fn exact(&self) -> Option<Given> {
        self.fraction.map(|(numerator, denominator)| Given::Fraction(numerator, denominator))
    }

    /// Less than zero.
    pub fn is_negative(&self) -> bool {
        self.value < 0.0
    }

    /// Greater than zero.
    pub fn is_positive(&self) -> bool {
        self.value > 0.0
    }

    /// How many times `step` goes into it, if that is a whole number.
    pub fn whole_multiple_of(&self, step: &Number) -> Option<u64> {
        match quotient(self.fraction?, step.fraction?)? {
            (count, 1) => u64::try_from(count).ok(),
            _ => None,
        }
    }

    /// This number divided by `parts`; by 0, unchanged.
    pub fn divided_by(&self, parts: u32) -> Number {
        let parts = parts.max(1);
        let fraction = self.fraction.and_then(|fraction| quotient(fraction, (parts.into(), 1)));
        let value = fraction.map_or(self.value / f64::from(parts), nearest);
        let text = match fraction {
            Some((whole, 1)) => whole.to_string(),
            Some((numerator, denominator)) => format!("{numerator}/{denominator}"),
            None => value.to_string(),
        };
        Self { text, value, fraction }
    }

    /// The `f64` nearest to `count` times it.
    pub fn times(&self, count: u64) -> f64 {
        let exact = |(numerator, denominator): Fraction| Some((numerator.checked_mul(count.into())?, denominator));
        self.fraction.and_then(exact).map_or(self.value * count as f64, nearest)
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
        let (value, fraction) = match text.split_once('/') {
            None => decimal(text)?,
            Some((numerator, denominator)) => {
                let ((numerator, above), (denominator, below)) = (decimal(numerator)?, decimal(denominator)?);
                if denominator == 0.0 {
                    return Err(NumberError::ZeroDenominator);
                }
                let fraction = above.zip(below).and_then(|(above, below)| quotient(above, below));
                (fraction.map_or(numerator / denominator, nearest), fraction)
            }
        };
        if value.is_finite() {
            Ok(Self { text: text.to_owned(), value, fraction })
        } else {
            Err(NumberError::NotFinite)
        }
    }
}

/// `[+-]digits[.digits][e[+-]digits]`: the nearest `f64`, and exactly.
fn decimal(text: &str) -> Result<(f64, Option<Fraction>), NumberError> {
    let value: f64 = text.parse().map_err(|_| NumberError::NotANumber)?;
    if !value.is_finite() {
        return Err(NumberError::NotFinite);
    }
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, places) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let exact = || {
        let digits: i128 = format!("{whole}{places}").parse().ok()?;
        let exponent = exponent.parse::<i32>().ok()?.checked_sub(places.len().try_into().ok()?)?;
        let power = 10_i128.checked_pow(exponent.unsigned_abs())?;
        if exponent < 0 { quotient((digits, 1), (power, 1)) } else { Some((digits.checked_mul(power)?, 1)) }
    };
    Ok((value, exact()))
}

/// `None` if it does not fit, or if `divisor` is zero.
fn quotient((a, b): Fraction, (c, d): Fraction) -> Option<Fraction> {
    let (above, below) = (a.checked_mul(d.into())?, c.checked_mul(b.into())?);
    let common = i128::try_from(gcd(above.unsigned_abs(), below.unsigned_abs())).ok().filter(|common| *common > 0)?;
    let sign = below.signum();
    Some((above / common * sign, u64::try_from(below / common * sign).ok().filter(|below| *below > 0)?))
}

fn gcd(a: u128, b: u128) -> u128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// The `f64` nearest to a fraction: 64 bits and more of its quotient, of which the last says whether any follow, rounded once.
fn nearest((numerator, denominator): Fraction) -> f64 {
    let (size, denominator) = (numerator.unsigned_abs(), u128::from(denominator));
    let shift = size.leading_zeros().min(127);
    let (quotient, rest) = ((size << shift) / denominator, (size << shift) % denominator);
    let size = (quotient | u128::from(rest != 0)) as f64 * f64::powi(0.5, shift as i32);
    if numerator < 0 { -size } else { size }
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
            ("1e-30", 1e-30),
            ("12345678901234567/7e5", 17636684144.62081),
            ("1e300/1e200", 1e100),
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
        assert_eq!(number("-1.5").times(2), -3.0);
    }

    #[test]
    fn parts_are_exact() {
        let part = number("0.1").divided_by(3);
        assert_eq!(part.to_string(), "1/30");
        assert_eq!(number("0.1").whole_multiple_of(&part), Some(3));
        assert_eq!(number("3").divided_by(3).to_string(), "1");
        assert_eq!(number("1e-30").divided_by(2).value(), 5e-31);
    }
}
