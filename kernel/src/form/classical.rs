//! The stages of classical RK4 in the direction form, for every kind of number that has one unit for all quantities.

use core::array::from_fn;

use super::equations::{Coefficients, Rates, Same, increments};
use super::inverse::Inverse;
use crate::ring::Ring;

/// k1 + 2 k2 + 2 k3 + k4 of the step from `z`, where the inverse is `inverse`, and the inverse at the last stage.
#[inline(always)]
pub(crate) fn stages<R: Ring<Gravity = R, Slope = R, Torque = R>, I: Inverse<R>>(
    coefficients: &Coefficients<R>,
    z: &[R; 6],
    inverse: R,
) -> ([R; 6], R) {
    let rates = |z: &[R; 6], r: R| rates(coefficients, z, r);
    let ahead = |k: &[R; 6]| -> [R; 6] { from_fn(|i| z[i] + k[i]) };
    // The inverse at z + k, where k was found at `from`: it falls by 2 S S' r^2.
    let follow = |k: &[R; 6], from: &[R; 6], r: R, to: &[R; 6]| {
        I::at_stage(inverse, k[2].twice() * (from[2] * r) * r, coefficients.denominator(to[2]))
    };

    let k1 = increments(z, rates(z, inverse));
    let z2 = ahead(&k1);
    let r2 = follow(&k1, z, inverse, &z2);

    let k2 = increments(&z2, rates(&z2, r2));
    let sum: [R; 6] = from_fn(|i| k1[i] + k2[i].twice());
    let z3 = ahead(&k2);
    let r3 = follow(&k2, &z2, r2, &z3);

    let twice_k3 = increments(&z3, rates(&z3, r3).doubled());
    let sum: [R; 6] = from_fn(|i| sum[i] + twice_k3[i]);
    let z4 = ahead(&twice_k3);
    let r4 = follow(&twice_k3, &z3, r3, &z4);

    let k4 = increments(&z4, rates(&z4, r4));
    (from_fn(|i| sum[i] + k4[i]), r4)
}

/// The rates at `z`, where the inverse is `inverse`.
#[inline(always)]
pub(crate) fn rates<R: Ring<Gravity = R, Slope = R, Torque = R>>(
    coefficients: &Coefficients<R>,
    &[sin1, cos1, s, c, p1, p2]: &[R; 6],
    inverse: R,
) -> Rates<R> {
    coefficients.rates(&Same, [sin1, cos1], [s, c], [p1, p2], inverse)
}

/// By how much of itself a vector (`s`, `c`), whose sum lacks `lost` in direction of it, is shorter than `length`, to first
/// order; `gain` is half the inverse of the length's square.
#[inline(always)]
pub(crate) fn missing<R: Ring>([s, c]: [R; 2], lost: R, length: R, gain: R) -> R {
    gain * (((length - c) * (length + c) - s * s) - (lost + lost))
}
