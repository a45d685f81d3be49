//! Sine and cosine of an `f32` in `f32` adds and multiplies only.
//!
//! The constants are made by `host-tests/generate/sine_polynomials.py`.

/// 2/pi.
const TWO_OVER_PI: f32 = core::f32::consts::FRAC_2_PI;

/// pi/2 in three parts. The first two hold 11 bits each, so that k times them is exact for every k up to 2^13.
const PI_OVER_TWO: [f32; 3] = [1.5703125, 0.0004837513, 0.0000000754979];

/// Adding this, 3 * 2^22, rounds to a whole number, which then stands in the low bits of the sum.
const ROUNDER: f32 = 12_582_912.0;

/// Up to here, rad, k stays below 2^13.
const LARGEST: f32 = 12_867.0;

/// (sin r - r)/r^3 in powers of r^2, for abs r <= pi/4; error of the fit 2.0e-9.
const SINE: [f32; 3] = [-0.1666665, 0.008331901, -0.00019485931];

/// (cos r - 1 + r^2/2)/r^4 in powers of r^2, for abs r <= pi/4; error of the fit 1.1e-10.
const COSINE: [f32; 3] = [0.041666646, -0.0013887301, 0.00002443067];

/// (sin `x`, cos `x`).
#[must_use]
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    if x.abs() <= LARGEST { reduced(x) } else { huge(x) }
}

/// Subtracts the nearest multiple of pi/2 and turns the pair of what is left by as many quarter turns.
#[inline]
fn reduced(x: f32) -> (f32, f32) {
    let rounded = x * TWO_OVER_PI + ROUNDER;
    let k = rounded - ROUNDER;
    let r = ((x - k * PI_OVER_TWO[0]) - k * PI_OVER_TWO[1]) - k * PI_OVER_TWO[2];
    super::by_quarters(first_octant(r), rounded.to_bits())
}

/// (sin `r`, cos `r`) for abs r <= pi/4, and a hair beyond.
#[inline]
fn first_octant(r: f32) -> (f32, f32) {
    let z = r * r;
    let sine = r + r * z * (SINE[0] + z * (SINE[1] + z * SINE[2]));
    let cosine = 1.0 - z * (0.5 - z * (COSINE[0] + z * (COSINE[1] + z * COSINE[2])));
    (sine, cosine)
}

/// Beyond the range of the reduction, by that of double precision; also NaN.
#[cold]
#[inline(never)]
fn huge(x: f32) -> (f32, f32) {
    let (s, c) = super::own_f64::sin_cos(x.into());
    (s as f32, c as f32)
}
