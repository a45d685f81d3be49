//! Numbers as text without floating-point formatting, which alone would take 14 KB of flash.
//!
//! A part of a label (a name, a digit, a unit) that does not fit is left out, with all later ones.
//! Numbers are limited to 4,294,967,295 units of their last decimal place.

use heapless::String;

/// A label in UTF-8. Its capacity, 16 bytes, is the number that fits next to the motion.
pub type Label = String<16>;

/// Returns the mass ratio m2/m1: `μ 100`, `μ 31.5`, `μ 2.75`, `μ 0.315`, `μ 0.0125`.
pub fn mass_ratio(ratio: f32) -> Label {
    let decimals = [100.0, 10.0, 1.0, 0.1]
        .into_iter()
        .take_while(|least| ratio < *least)
        .count();
    label("μ ", ratio, decimals as u32, "")
}

/// Returns a start angle after its name, with a decimal if it is not whole: `α 120°`, `α 12.5°`.
pub fn degrees(name: &str, degrees: f64) -> Label {
    let degrees = degrees as f32;
    let decimals = if degrees == (degrees as i32) as f32 {
        0
    } else {
        1
    };
    label(name, degrees, decimals, "°")
}

/// Returns a number of an axis before its unit: `10`, `0.2 s`. It has one decimal from 0.1 to 1,
/// two from 0.01, and else none.
pub fn tick(value: f32, unit: &str) -> Label {
    let decimals = match value {
        0.1..1.0 => 1,
        0.01..0.1 => 2,
        _ => 0,
    };
    label("", value, decimals, unit)
}

/// Returns a time after a name, rounded down to tenths of a second, to seconds from 1,000 s on, and
/// to tenths of an hour from 100,000 s on: `½px 12.3 s`, `½px 1234 s`, `½px 27.7 h`.
pub fn rounded_down(name: &str, seconds: f32) -> Label {
    tenths(name, (seconds * 10.0) as u32)
}

/// Returns a time, rounded down as by [`rounded_down`]: `12.3 s`.
pub fn time(seconds: f64) -> Label {
    tenths("", (seconds * 10.0) as u32)
}

/// Returns a time in tenths of a second, after a name.
fn tenths(name: &str, tenths: u32) -> Label {
    let (number, parts, unit) = match tenths {
        1_000_000.. => (tenths / 3600, 10, " h"),
        10_000.. => (tenths / 10, 1, " s"),
        _ => (tenths, 10, " s"),
    };
    written([name, ""], number, parts, unit)
}

/// Returns `value`, rounded to at most 9 decimals, after a name and before a unit: `±12°`, `ω₁
/// 1.848`, `true -18.7 J`.
#[inline(never)] // Inlined, it takes 992 bytes of flash (M3).
pub fn label(name: &str, value: f32, decimals: u32, unit: &str) -> Label {
    let one = 10_u32.saturating_pow(decimals);
    let sign = if value < 0.0 { "-" } else { "" };
    written(
        [name, sign],
        (value.abs() * one as f32 + 0.5) as u32,
        one,
        unit,
    )
}

/// Returns a number in units of 1/`one`, where `one` is a power of ten, between `head` and `unit`.
fn written(head: [&str; 2], number: u32, one: u32, unit: &str) -> Label {
    let mut label = Label::new();
    let mut write = || {
        head.iter().try_for_each(|part| label.push_str(part))?;

        // The digits, from the highest power of ten down.
        let mut power = one;
        let mut rest = number;
        while power <= number / 10 {
            power *= 10;
        }
        while let Some(digit) = rest.checked_div(power) {
            label.push(char::from(b'0' + digit as u8))?;
            if power == one && one > 1 {
                label.push('.')?;
            }
            rest -= digit * power;
            power /= 10;
        }
        label.push_str(unit)
    };

    // A label that is too long is cut off. A panel offers no better way.
    let _ = write();
    label
}
