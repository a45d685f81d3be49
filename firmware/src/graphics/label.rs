//! Numbers as text without floating-point formatting, which alone would take 14 KB of flash.

use core::fmt::Write;

use heapless::String;

/// A label: at most the characters that fit beside the motion.
pub type Label = String<12>;

/// The mass ratio to three significant digits: `μ 100`, `μ 31.5`, `μ 2.75`, `μ 0.315`, `μ 0.0125`.
pub fn mass_ratio(ratio: f32) -> Label {
    let decimals = match ratio {
        100.0.. => 0,
        10.0.. => 1,
        1.0.. => 2,
        0.1.. => 3,
        _ => 4,
    };
    label("μ ", ratio, decimals, "")
}

/// The start angle: `α 120°`, with one decimal if it is no whole number of degrees.
pub fn degrees(degrees: f32) -> Label {
    let decimals = if degrees == (degrees as i32) as f32 { 0 } else { 1 };
    label("α ", degrees, decimals, "°")
}

/// A frequency in sqrt(g/l): `ω 1.848`.
pub fn frequency(frequency: f32) -> Label {
    label("ω ", frequency, 3, "")
}

/// A number to one decimal with its unit: `-18.7 J`.
pub fn tenths(value: f32, unit: &str) -> Label {
    label("", value, 1, unit)
}

/// Until when the frame is right to half a pixel, s: `½ 8.4`, and `½ ok` as long as it is.
pub fn trust(until: f32) -> Label {
    match until {
        0.0..1e3 => label("½ ", until, 1, ""),
        1e3..1e9 => label("½ ", until, 0, ""),
        _ => Label::try_from("½ ok").unwrap_or_default(),
    }
}

/// The time since the start to a tenth of a second: `12.3 s`.
pub fn time(seconds: f64) -> Label {
    let tenths = (seconds * 10.0) as u32;
    let mut label = Label::new();
    // A label too long for its place ends early; there is nothing else to do about it on a panel.
    let _ = write!(label, "{}.{} s", tenths / 10, tenths % 10);
    label
}

/// `value` rounded to `decimals` places between two texts.
fn label(before: &str, value: f32, decimals: u32, after: &str) -> Label {
    let unit = 10_u32.saturating_pow(decimals).max(1);
    let rounded = (value.abs() * unit as f32 + 0.5) as u32;
    let sign = if value < 0.0 { "-" } else { "" };
    let (whole, fraction) = (rounded / unit, rounded % unit);
    let mut label = Label::new();
    let _ = match decimals {
        0 => write!(label, "{before}{sign}{whole}{after}"),
        _ => write!(label, "{before}{sign}{whole}.{fraction:0width$}{after}", width = decimals as usize),
    };
    label
}
