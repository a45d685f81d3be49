//! Numbers as users write them: decimals (`0.25`, `1e-3`) and fractions (`1/256`).

use std::fmt;
use std::str::FromStr;

/// A number with its text, which is printed as it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    text: String,
    value: f64,
    fraction: Option<Fraction>,
}

/// A numerator over a denominator greater than zero.
pub type Fraction = (i64, u64);

pub const FEWER_DIGITS: &str = "write at most 18 digits, counting the zeros that an exponent adds";

const NOT_A_NUMBER: &str = "not a number (write a decimal or a fraction such as 1/256)";
const NOT_FINITE: &str = "must be a finite number";
const ZERO_DENOMINATOR: &str = "the denominator is zero";

impl Number {
    /// Returns the nearest `f64`. Only a fraction with numbers of more than 53 bits may be a few
    /// units of the last place off.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Returns the exact value, or `None` if a number of it does not fit in 64 bits.
    pub fn exact(&self) -> Option<Fraction> {
        self.fraction
    }

    /// Returns `count`/`parts` of the number, rounded once if the numbers are short: 3 times 0.1 is
    /// 0.3.
    pub fn times(&self, count: u32, parts: u32) -> f64 {
        let [count, parts] = [count, parts].map(f64::from);
        self.fraction
            .map_or(self.value * count / parts, |(above, below)| {
                above as f64 * count / (below as f64 * parts)
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

        // A decimal was rounded by its parser, a fraction is rounded once.
        let fraction = above
            .zip(below)
            .and_then(|(above, below)| quotient(above, below));
        let value = match fraction {
            Some((above, below)) if text.contains('/') => above as f64 / below as f64,
            _ => numerator / denominator,
        };
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

fn decimal(text: &str) -> Result<(f64, Option<Fraction>), &'static str> {
    let value: f64 = text.parse().map_err(|_| NOT_A_NUMBER)?;
    if !value.is_finite() {
        return Err(NOT_FINITE);
    }
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, places) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let exact = || {
        let digits: i64 = format!("{whole}{places}").parse().ok()?;
        let exponent = exponent
            .parse::<i32>()
            .ok()?
            .checked_sub(places.len().try_into().ok()?)?;
        let power = 10_i64.checked_pow(exponent.unsigned_abs())?;
        if exponent < 0 {
            Some((digits, power.unsigned_abs()))
        } else {
            Some((digits.checked_mul(power)?, 1))
        }
    };
    Ok((value, exact()))
}

fn quotient((a, b): Fraction, (c, d): Fraction) -> Option<Fraction> {
    let above = a.checked_mul(d.try_into().ok()?)?.checked_mul(c.signum())?;
    let below = b.checked_mul(c.unsigned_abs())?;
    (below > 0).then_some((above, below))
}

/// Two numbers separated by a comma: one for each bob or rod.
#[derive(Clone, Debug)]
pub struct Pair(pub Number, pub Number);

impl Pair {
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

    #[test]
    fn multiples_are_rounded_once() -> Result<(), &'static str> {
        for (one, count, parts, product) in [
            ("0.1", 3, 1, 0.3),
            ("1/3", 3, 1, 1.0),
            ("1", 7, 100, 0.07),
            ("1e-30", 2, 1, 2e-30),
        ] {
            assert_eq!(one.parse::<Number>()?.times(count, parts), product, "{one}");
        }
        Ok(())
    }
}
