//! Sine and cosine of an `f64` in `f64` adds and multiplies only, few of them: on a Cortex-M each is a call.
//!
//! The constants are made by `host-tests/generate/sine_polynomials.py`.

/// 2/pi.
const TWO_OVER_PI: f64 = core::f64::consts::FRAC_2_PI;

/// pi/2 in three parts. The first two hold 33 bits each, so that k times them is exact for every k up to 2^20.
const PI_OVER_TWO: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];

/// Adding this, 3 * 2^51, rounds to a whole number, which then stands in the low bits of the sum.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Up to here, rad, k stays below 2^20.
const LARGEST: f64 = 1_647_098.0;

/// (sin r - r)/r^3 in powers of r^2, for abs r <= pi/4; error of the fit 4.0e-18 of sin r.
const SINE: [f64; 6] = [
    -0.16666666666666627,
    0.008333333333321079,
    -0.0001984126982870105,
    2.7557313296331277e-6,
    -2.505069457811957e-8,
    1.589303094330697e-10,
];

/// (cos r - 1 + r^2/2)/r^4 in powers of r^2, for abs r <= pi/4; error of the fit 5.8e-20.
const COSINE: [f64; 6] = [
    0.04166666666666659,
    -0.0013888888888872056,
    0.000024801587288144706,
    -2.7557313954278097e-7,
    2.08756677675132e-9,
    -1.1356709826679715e-11,
];

/// (sin `x`, cos `x`).
#[must_use]
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    if x.abs() <= LARGEST { reduced(x) } else { huge(x) }
}

/// Subtracts the nearest multiple of pi/2, rounding once, and turns the pair of what is left by as many quarter turns.
#[inline]
fn reduced(x: f64) -> (f64, f64) {
    let rounded = x * TWO_OVER_PI + ROUNDER;
    let k = rounded - ROUNDER;
    let coarse = x - k * PI_OVER_TWO[0];
    let middle = k * PI_OVER_TWO[1];
    let rough = coarse - middle;
    let lost = ((coarse - rough) - middle) - k * PI_OVER_TWO[2];
    let r = rough + lost;
    super::by_quarters(first_octant(r), rounded.to_bits() as u32)
}

/// (sin `r`, cos `r`) for abs r <= pi/4, and a hair beyond.
#[inline]
fn first_octant(r: f64) -> (f64, f64) {
    let z = r * r;
    let [s1, s2, s3, s4, s5, s6] = SINE;
    let [c1, c2, c3, c4, c5, c6] = COSINE;
    let sine = r + r * z * (s1 + z * (s2 + z * (s3 + z * (s4 + z * (s5 + z * s6)))));
    let cosine = 1.0 - z * (0.5 - z * (c1 + z * (c2 + z * (c3 + z * (c4 + z * (c5 + z * c6))))));
    (sine, cosine)
}

/// Beyond the range of the reduction; also NaN.
#[cold]
#[inline(never)]
fn huge(x: f64) -> (f64, f64) {
    libm::sincos(x)
}
