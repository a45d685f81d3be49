//! Sines and cosines with few additions and multiplications, because each is a call in software.
//!
//! The argument is reduced by the nearest multiple of pi/2 (Cody-Waite reduction). Then minimax
//! polynomials are used. `host-tests/exact/sine_polynomials.py` computes the constants.
//!
//! No `f64` is pi. A pendulum that starts straight up would fall if the `f64` nearest to pi were
//! taken literally. So a whole number times the `f64` nearest to pi/2 is that number of quarter
//! turns here, and its sine and cosine are exact. Angles beyond 1.6e6 rad are reduced by turns of
//! that length, too. The change is smaller than half a unit in the last place of the angle. An
//! `f32` up to 1.6e6 is taken literally.

use core::ops::Neg;

use super::Real;

/// Returns an angle of `degrees`, rad, whose [`sin_cos`](crate::sin_cos) has the direction of that
/// angle, exactly at multiples of 90 degrees.
///
/// The result is the `f64` nearest to pi/180 times `degrees`, except that one number in 10^7 is off
/// by a unit in the last place, and that multiples of 90 degrees are multiples of the `f64` nearest
/// to pi/2.
///
/// ```
/// use double_pendulum::{radians, sin_cos};
///
/// assert_eq!(sin_cos(radians(180.0)), (0.0, -1.0));
/// assert_eq!(sin_cos(radians(-270.0)), (1.0, 0.0));
/// assert_eq!(radians(30.0), core::f64::consts::FRAC_PI_6);
/// ```
#[must_use]
pub fn radians(degrees: f64) -> f64 {
    /// pi/180, first the upper 26 bits and then the rest, so that products of halves are exact.
    const DEGREE: [f64; 2] = [0.01745329238474369, 1.3519960527851425e-10];

    let quarters = degrees / 90.0;
    if libm::rint(quarters) == quarters && quarters * 90.0 == degrees {
        return quarters * core::f64::consts::FRAC_PI_2;
    }

    let upper = upper_half(degrees);
    let lower = degrees - upper;
    upper * DEGREE[0] + (lower * DEGREE[0] + degrees * DEGREE[1])
}

/// Returns the first 26 bits of the significand.
fn upper_half(x: f64) -> f64 {
    const LOWER: u64 = (1 << 27) - 1;
    f64::from_bits(x.to_bits() & !LOWER)
}

#[inline] // With `own_sin_cos`: 6.2 KB more flash on an M4F without.
pub(super) fn single(x: f32) -> (f32, f32) {
    /// pi/2 in three parts. The first two have 11 bits each, so that their products with k are
    /// exact for every k up to 2^13.
    const PI_OVER_TWO: [f32; 3] = [1.5703125, 0.0004837513, 0.0000000754979];
    const LARGEST: f32 = 12_867.0;
    /// 3 * 2^22. Adding it leaves the nearest whole number in the low bits of the sum.
    const ROUNDER: f32 = 12_582_912.0;
    /// (sin r - r)/r^3 in powers of r^2, for |r| <= pi/4. The error of the fit is 2.0e-9.
    const SINE: [f32; 3] = [-0.1666665, 0.008331901, -0.00019485931];
    /// (cos r - 1 + r^2/2)/r^4 in powers of r^2, for |r| <= pi/4. The error of the fit is 1.1e-10.
    const COSINE: [f32; 3] = [0.041666646, -0.0013887301, 0.00002443067];

    #[cold]
    fn huge(x: f32) -> (f32, f32) {
        let (s, c) = double(x.into());
        (s as f32, c as f32)
    }

    if x.abs() <= LARGEST {
        // k is the number of quarter turns, and r the rest of the argument.
        let rounded = x * core::f32::consts::FRAC_2_PI + ROUNDER;
        let k = rounded - ROUNDER;
        let r = ((x - k * PI_OVER_TWO[0]) - k * PI_OVER_TWO[1]) - k * PI_OVER_TWO[2];
        by_quarters(first_octant(r, SINE, COSINE), rounded.to_bits())
    } else {
        huge(x)
    }
}

pub(super) fn double(mut x: f64) -> (f64, f64) {
    /// pi/2 in three parts. The first two have 33 bits each, so that their products with k are
    /// exact for every k up to 2^20.
    const PI_OVER_TWO: [f64; 3] = [
        1.5707963267341256,
        6.077100506303966e-11,
        2.0222662487959506e-21,
    ];
    const LARGEST: f64 = 1_647_098.0;
    /// The `f64` nearest to 2 pi, first the upper 26 bits and then the rest.
    const TURN: [f64; 2] = [6.283185243606567, 6.357301884918343e-08];
    const ROUNDER: f64 = 6_755_399_441_055_744.0;
    /// The rest of a multiple of the `f64` nearest to pi/2 is smaller: below 3e-10.
    const NEAREST: f64 = 1e-9;
    /// The same series as in [`single`]. The error of the fit is 4.0e-18 of sin r.
    const SINE: [f64; 6] = [
        -0.16666666666666627,
        0.008333333333321079,
        -0.0001984126982870105,
        2.7557313296331277e-6,
        -2.505069457811957e-8,
        1.589303094330697e-10,
    ];
    /// The error of the fit is 5.8e-20.
    const COSINE: [f64; 6] = [
        0.04166666666666659,
        -0.0013888888888872056,
        0.000024801587288144706,
        -2.7557313954278097e-7,
        2.08756677675132e-9,
        -1.1356709826679715e-11,
    ];

    while x.abs() > LARGEST {
        // Products with 26 bits of the number of turns are exact.
        let turns = upper_half(libm::rint(x / core::f64::consts::TAU));
        x = (x - turns * TURN[0]) - turns * TURN[1];
    }

    let rounded = x * core::f64::consts::FRAC_2_PI + ROUNDER;
    let k = rounded - ROUNDER;
    // The rest of the argument is rounded only once.
    let coarse = x - k * PI_OVER_TWO[0];
    let middle = k * PI_OVER_TWO[1];
    let rough = coarse - middle;
    let lost = ((coarse - rough) - middle) - k * PI_OVER_TWO[2];
    let rest = rough + lost;
    let quarters = rounded.to_bits() as u32;
    // The comparison of `rest` saves nearly all angles the product.
    if rest.abs() < NEAREST && k != 0.0 && x == k * core::f64::consts::FRAC_PI_2 {
        let (sine, cosine) = by_quarters((0.0, 1.0), quarters);
        // The sine of pi is 0 and not -0, whose `atan2` would be -pi.
        let sine = if sine == 0.0 {
            libm::copysign(sine, x)
        } else {
            sine
        };
        (sine, cosine)
    } else {
        by_quarters(first_octant(rest, SINE, COSINE), quarters)
    }
}

fn first_octant<R: Real, const N: usize>(r: R, sine: [R; N], cosine: [R; N]) -> (R, R) {
    let z = r * r;
    let series = |terms: [R; N]| {
        (0..N - 1)
            .rev()
            .fold(terms[N - 1], |sum, i| terms[i] + z * sum)
    };
    (
        r + r * z * series(sine),
        R::ONE - z * (R::HALF - z * series(cosine)),
    )
}

fn by_quarters<R: Neg<Output = R>>((sine, cosine): (R, R), quarters: u32) -> (R, R) {
    let (sine, cosine) = if quarters & 1 == 0 {
        (sine, cosine)
    } else {
        (cosine, -sine)
    };

    if quarters & 2 == 0 {
        (sine, cosine)
    } else {
        (-sine, -cosine)
    }
}
