//! Numbers as users write them: decimals (`0.25`, `1e-3`) and fractions (`1/256`), stored exactly.

use std::fmt;
use std::str::FromStr;

/// A number with its text: a decimal such as `-2.5`, `.5` or `1e-3`, or two of them with a `/`
/// between them and no spaces. A number that was parsed is finite: `inf`, `1e999` and `1/0` are
/// refused. The error of the parser is the reason, in words for the user. Numbers are equal only if
/// their texts are, too.
///
/// It is printed as it was written; after [`Number::divided_by`], as a whole number or a fraction
/// or, if the exact value is unknown, as a decimal, `inf` or `NaN`.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    text: String,
    value: f64,
    /// The exact value. It is `None` if this, or a number of the text, does not fit in 64 bits;
    /// only `value` is known then.
    fraction: Option<Fraction>,
}

/// A numerator over a denominator greater than zero, in lowest terms; zero is (0, 1). The functions
/// here return no other; the type does not check it.
pub type Fraction = (i64, u64);

/// The remedy for a number without an [exact](Number::exact) value.
pub const FEWER_DIGITS: &str = "write at most 18 digits, counting the zeros that an exponent adds";

/// The reasons why a text is not a [`Number`].
const NOT_A_NUMBER: &str = "not a number (write a decimal or a fraction such as 1/256)";
const NOT_FINITE: &str = "must be a finite number";
const ZERO_DENOMINATOR: &str = "the denominator is zero";

impl Number {
    /// Returns the number 1, with the text `1`.
    pub fn one() -> Self {
        Self {
            text: "1".to_owned(),
            value: 1.0,
            fraction: Some((1, 1)),
        }
    }

    /// Returns the number as the nearest `f64`. Only a fraction or a quotient whose exact value is
    /// unknown or has numbers of more than 53 bits may be a few units of the last place off.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Returns the exact value, in lowest terms, or `None` if only [`Number::value`] is known,
    /// because the exact value or a number of the text does not fit in 64 bits. A decimal and a
    /// fraction of whole numbers always fit if each number has at most 18 digits, including the
    /// zeros that an exponent adds. A fraction of decimals of this length may not fit.
    pub fn exact(&self) -> Option<Fraction> {
        self.fraction
    }

    /// Returns true if [`Number::value`] is greater than zero, also if it is infinite. A positive
    /// number that is rounded to 0 is not, nor is NaN.
    pub fn is_positive(&self) -> bool {
        self.value > 0.0
    }

    /// Returns how many times `step` divides the number, computed exactly. Returns `None` if that
    /// is not a whole number from 0 to 2^63 - 1, if `step` is zero, or if one of the exact values
    /// is unknown.
    pub fn whole_multiple_of(&self, step: &Number) -> Option<u64> {
        let (count, parts) = quotient(self.fraction?, step.fraction?)?;
        count.try_into().ok().filter(|_| parts == 1)
    }

    /// Returns the number divided by `parts`; by 0 it is infinite or NaN, without an exact value.
    /// Otherwise a known exact value stays known unless it no longer fits in 64 bits.
    pub fn divided_by(&self, parts: u32) -> Number {
        let fraction = self
            .fraction
            .and_then(|fraction| quotient(fraction, (parts.into(), 1)));
        let value = fraction.map_or(self.value / f64::from(parts), nearest);
        let text = match fraction {
            Some((whole, 1)) => whole.to_string(),
            Some((above, below)) => format!("{above}/{below}"),
            None => value.to_string(),
        };
        Self {
            text,
            value,
            fraction,
        }
    }

    /// Returns `count` times the number. It is the nearest `f64` if the exact value is known and
    /// its numerator times `count` and its denominator have at most 53 bits each; otherwise it may
    /// be a few units of the last place off. It is infinite if the product exceeds the range of
    /// `f64`. An infinite number times 0 is NaN.
    pub fn times(&self, count: u64) -> f64 {
        let count = count as f64;
        self.fraction.map_or(self.value * count, |(above, below)| {
            above as f64 * count / below as f64
        })
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl FromStr for Number {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, &'static str> {
        let (above, below) = text.split_once('/').unwrap_or((text, "1"));
        let (numerator, above) = decimal(above)?;
        let (denominator, below) = decimal(below)?;
        if denominator == 0.0 {
            return Err(ZERO_DENOMINATOR);
        }

        // A fraction is the nearest `f64` to its exact value. A decimal was rounded by its parser.
        let fraction = above
            .zip(below)
            .and_then(|(above, below)| quotient(above, below));
        let is_decimal = !text.contains('/');
        let value = fraction
            .filter(|_| !is_decimal)
            .map_or(numerator / denominator, nearest);
        if value.is_finite() {
            Ok(Self {
                text: text.to_owned(),
                value,
                fraction,
            })
        } else {
            Err(NOT_FINITE)
        }
    }
}

/// Parses `[+-]digits[.digits][e[+-]digits]`. Returns the nearest `f64`, and the exact value if it
/// fits.
fn decimal(text: &str) -> Result<(f64, Option<Fraction>), &'static str> {
    let value: f64 = text.parse().map_err(|_| NOT_A_NUMBER)?;
    if !value.is_finite() {
        return Err(NOT_FINITE);
    }
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, places) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    // The digits without the point are a whole number, times a power of ten.
    let exact = || {
        let digits: i64 = format!("{whole}{places}").parse().ok()?;
        let exponent = exponent
            .parse::<i32>()
            .ok()?
            .checked_sub(places.len().try_into().ok()?)?;
        let power = 10_i64.checked_pow(exponent.unsigned_abs())?;
        if exponent < 0 {
            quotient((digits, 1), (power, 1))
        } else {
            Some((digits.checked_mul(power)?, 1))
        }
    };
    Ok((value, exact()))
}

/// Returns the quotient of two fractions, or `None` if it does not fit or the divisor is zero.
fn quotient((a, b): Fraction, (c, d): Fraction) -> Option<Fraction> {
    let above = i128::from(a) * i128::from(d);
    let below = i128::from(c) * i128::from(b);
    // Euclid's algorithm for the common divisor of numerator and denominator.
    let mut common = above.abs();
    let mut rest = below.abs();
    while rest != 0 {
        (common, rest) = (rest, common % rest);
    }
    let divisor = common * below.signum();
    Some((
        above.checked_div(divisor)?.try_into().ok()?,
        below.checked_div(divisor)?.try_into().ok()?,
    ))
}

/// Returns the `f64` nearest to a fraction, if neither of its numbers has more than 53 bits.
fn nearest((above, below): Fraction) -> f64 {
    above as f64 / below as f64
}

/// Two numbers separated by a comma: one for each bob or rod, number 1 first. Spaces around a
/// number are accepted, and not printed. Any other text is refused, with the reason in words.
#[derive(Clone, Debug)]
pub struct Pair(pub Number, pub Number);

impl Pair {
    /// Returns the [`Number::value`] of both, in their order.
    pub fn values(&self) -> [f64; 2] {
        [self.0.value(), self.1.value()]
    }
}

impl fmt::Display for Pair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{}", self.0, self.1)
    }
}

impl FromStr for Pair {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (first, second) = text
            .split_once(',')
            .ok_or("write two numbers with a comma between them")?;
        let number = |text: &str| {
            text.trim()
                .parse()
                .map_err(|error| format!("'{text}': {error}"))
        };
        Ok(Pair(number(first)?, number(second)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A decimal or a fraction is read as the `f64` nearest to its exact value. Other texts,
    /// numbers that are not finite and a denominator of zero are refused with their reason.
    #[test]
    fn decimals_and_fractions_round_once_and_other_text_is_refused() {
        for (text, value) in [
            ("0.1", Ok(0.1)),
            ("-2.5e-3", Ok(-2.5e-3)),
            (".5", Ok(0.5)),
            ("+7.", Ok(7.0)),
            ("1/3", Ok(1.0 / 3.0)),
            ("-0.1/0.3", Ok(-1.0 / 3.0)),
            ("5e-324", Ok(5e-324)),
            ("1e300/1e200", Ok(1e100)),
            ("", Err(NOT_A_NUMBER)),
            ("1/2/3", Err(NOT_A_NUMBER)),
            ("nan", Err(NOT_FINITE)),
            ("1e999", Err(NOT_FINITE)),
            ("1e300/1e-300", Err(NOT_FINITE)),
            ("1/0", Err(ZERO_DENOMINATOR)),
        ] {
            assert_eq!(
                text.parse().map(|number: Number| number.value()),
                value,
                "{text}"
            );
        }
    }

    /// Whole multiples are recognised by the exact fractions, such as 10 as 100 times 0.1. A part
    /// of a number is the exact fraction, unless that is too long, and a multiple is rounded once.
    #[test]
    fn multiples_and_parts_are_exact() -> Result<(), &'static str> {
        for (time, step, count) in [
            ("10", "0.1", Some(100)),
            ("5", "1/4096", Some(20480)),
            ("1", "1/3", Some(3)),
            ("1", "0.3", None),
            ("-1", "0.5", None),
            ("1", "0", None),
        ] {
            assert_eq!(
                time.parse::<Number>()?.whole_multiple_of(&step.parse()?),
                count,
                "{time} of {step}"
            );
        }

        // A part keeps its exact fraction, so that the product with the number of parts has one
        // rounding.
        for (one, parts, part, times) in [
            ("0.1", 3, "1/30", 0.3),
            ("3", 3, "1", 9.0),
            ("1e-30", 2, "0.0000000000000000000000000000005", 2e-30),
        ] {
            let one = one.parse::<Number>()?;
            assert_eq!(
                (one.divided_by(parts).to_string(), one.times(parts.into())),
                (part.to_owned(), times),
                "{one}"
            );
        }

        Ok(())
    }
}
