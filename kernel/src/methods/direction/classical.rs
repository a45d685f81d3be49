//! The stages of classical RK4 in the direction form, for every kind of number that has one unit for all quantities.
//!
//! Loops and functions rather than array methods and closures, which are not always inlined in code for a processor's vectors.

use crate::numbers::Scalar;
use crate::pendulum::directions::{Coefficients, Rates, Same, increments};

/// A motion's z, and r there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<R> {
    pub z: [R; 6],
    pub inverse: R,
}

/// A step half made: where the next k is found, and the sum of those so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stage<R> {
    at: Point<R>,
    sum: [R; 6],
}

/// k1 + 2 k2 + 2 k3 + k4 of the step from `start`, and the inverse at the last stage.
#[inline(always)]
pub(crate) fn stages<R: Scalar<Gravity = R, Slope = R, Torque = R>>(
    coefficients: &Coefficients<R>,
    start: &Point<R>,
) -> ([R; 6], R) {
    let mut stage = Stage::first(coefficients, start);
    stage.second(coefficients, start);
    stage.third(coefficients, start);
    stage.last(coefficients)
}

impl<R: Scalar<Gravity = R, Slope = R, Torque = R>> Stage<R> {
    /// After k1.
    #[inline(always)]
    pub fn first(coefficients: &Coefficients<R>, start: &Point<R>) -> Self {
        let k1 = increments(&start.z, start.rates(coefficients));
        Self { at: start.ahead(&k1, start), sum: k1 }
    }

    /// After k2.
    #[inline(always)]
    pub fn second(&mut self, coefficients: &Coefficients<R>, start: &Point<R>) {
        let k2 = increments(&self.at.z, self.at.rates(coefficients));
        self.sum = with(&self.sum, &k2, |sum, k2| sum + k2.twice());
        self.at = start.ahead(&k2, &self.at);
    }

    /// After k3.
    #[inline(always)]
    pub fn third(&mut self, coefficients: &Coefficients<R>, start: &Point<R>) {
        let twice_k3 = increments(&self.at.z, self.at.rates(coefficients).doubled());
        self.sum = with(&self.sum, &twice_k3, R::add);
        self.at = start.ahead(&twice_k3, &self.at);
    }

    /// As of [`stages`].
    #[inline(always)]
    pub fn last(&self, coefficients: &Coefficients<R>) -> ([R; 6], R) {
        let k4 = increments(&self.at.z, self.at.rates(coefficients));
        (with(&self.sum, &k4, R::add), self.at.inverse)
    }
}

impl<R: Scalar<Gravity = R, Slope = R, Torque = R>> Point<R> {
    #[inline(always)]
    fn rates(&self, coefficients: &Coefficients<R>) -> Rates<R> {
        coefficients.rates(&Same, &self.z, self.inverse)
    }

    /// The point `k` further, where `k` was found at `from`: the inverse falls by 2 S S' r^2.
    #[inline(always)]
    fn ahead(&self, k: &[R; 6], from: &Self) -> Self {
        let z = with(&self.z, k, R::add);
        let fall = k[2].twice() * (from.z[2] * from.inverse) * from.inverse;
        Self { z, inverse: self.inverse - fall }
    }
}

#[inline(always)]
fn with<R: Copy>(one: &[R; 6], other: &[R; 6], operation: impl Fn(R, R) -> R) -> [R; 6] {
    let mut all = *one;
    for (one, other) in all.iter_mut().zip(other) {
        *one = operation(*one, *other);
    }
    all
}

/// r = 1/(m + S^2) at the end of a step, by one Newton step from that of its last stage, which is off by the third power of
/// the step. A step that changes r by a third or more makes no sense with it, nor with RK4.
#[inline(always)]
pub(crate) fn newton_inverse<R: Scalar>(last: R, inertia: R, s: R) -> R {
    last + last * ((R::from_f64(1.0) - inertia * last) - (s * last) * s)
}

/// By how much of itself a vector (`s`, `c`), whose sum lacks `lost` in direction of it, is shorter than `length`, to first
/// order; `gain` is half the inverse of the length's square.
#[inline(always)]
pub(crate) fn missing<R: Scalar>([s, c]: [R; 2], lost: R, length: R, gain: R) -> R {
    gain * (((length - c) * (length + c) - s * s) - (lost + lost))
}
