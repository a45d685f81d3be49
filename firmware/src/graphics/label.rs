//! Numbers as text without floating-point formatting, which alone would take 14 KB of flash.
//!
//! A name in front and a unit behind are written as they are, with the space that they contain. If
//! a part of a label (a name, a digit, a unit) does not fit, it and the later parts are left out.
//! NaN is written as 0, or 0.0 and so on with decimals. A number of more than 4,294,967,295 units
//! of its last decimal place, or infinity, is written as that limit; the sign remains.

use heapless::String;

/// A label in UTF-8. Its capacity, 16 bytes, is the number that fits next to the motion.
pub type Label = String<16>;

/// Returns the mass ratio m2/m1, rounded to three significant digits, from 100 on to whole numbers,
/// and below 0.1 to four decimals: `μ 100`, `μ 31.5`, `μ 2.75`, `μ 0.315`, `μ 0.0125`. The number
/// of decimals is chosen before rounding: 9.996 gives `μ 10.00`. A negative ratio, which no
/// pendulum has, has a sign and four decimals. NaN gives `μ 0`.
pub fn mass_ratio(ratio: f32) -> Label {
    let decimals = [100.0, 10.0, 1.0, 0.1]
        .into_iter()
        .take_while(|least| ratio < *least)
        .count();
    label("μ ", ratio, decimals as u32, "")
}

/// Returns a start angle, degrees, after its name: `α 120°`. It is rounded to one decimal if it is
/// not a whole number of degrees: `α 12.5°`. NaN gives `0.0°`.
pub fn degrees(name: &str, degrees: f64) -> Label {
    let degrees = degrees as f32;
    let decimals = if degrees == (degrees as i32) as f32 {
        0
    } else {
        1
    };
    label(name, degrees, decimals, "°")
}

/// Returns a number of an axis, before its unit: `10`, `0.2 s`. It is rounded to one decimal from
/// 0.1 to below 1, and to two from 0.01 to below 0.1. Every other number is rounded to a whole
/// number, such as 2.5 to `3`, 0.005 to `0` and -0.2 to `-0`.
pub fn tick(value: f32, unit: &str) -> Label {
    let decimals = match value {
        0.1..1.0 => 1,
        0.01..0.1 => 2,
        _ => 0,
    };
    label("", value, decimals, unit)
}

/// Returns a time, s, after a name and before its unit, rounded down to tenths of a second, to
/// seconds from 1,000 s on, and to tenths of an hour from 100,000 s on: `½px 12.3 s`, `½px 1234 s`,
/// `½px 27.7 h`. A negative time is written as 0.
pub fn rounded_down(name: &str, seconds: f32) -> Label {
    tenths(name, (seconds * 10.0) as u32)
}

/// Returns a time, s, rounded down as by [`rounded_down`]: `12.3 s`. A negative time is written as
/// 0.
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

/// Returns `value`, rounded to `decimals` places, after a name and before a unit. A negative value
/// that is rounded to 0 keeps its sign. Halves are rounded away from 0. Examples: `±12°`, `ω₁
/// 1.848`, `true -18.7 J`. Not checked: `decimals` is 0 to 9; with more, the digits are wrong.
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
