//! The direction form of Hamilton's equations, which the fast methods use.
//!
//! # Equations
//!
//! The equations of motion contain the angles only as sines and cosines. The direction form
//! therefore carries sines and cosines instead of angles, and a step needs no trigonometry:
//!
//! - sin a1 and cos a1, the direction of rod 1;
//! - S = nu sin (a1 - a2) and C = nu cos (a1 - a2), where nu = l1/l2;
//! - P1 and P2, the momenta p1 and p2 times tau/(m2 l2^2), where tau is the unit of time.
//!
//! With m = (m1/m2) nu^2, G2 = tau^2 g/l1 and G1 = (m + nu^2) G2, the equations are:
//!
//! ```text
//! r = 1/(m + S^2)      u = a1' = (P1 - C P2) r      v = a2' = P2 - C u      F = u v S
//!
//! (sin a1)' = u cos a1      S' = (u - v) C       P1' = -G1 sin a1 - F
//! (cos a1)' = -u sin a1     C' = -(u - v) S      P2' = -G2 (C sin a1 - S cos a1) + F
//! ```
//!
//! Fixed point of 32 and of 64 bits has its own copy each; in floating point all methods share
//! [`rates`] and [`changes`]. The unit test `every_form_is_that_of_hamiltons_equations` compares
//! them with Hamilton's equations.
//!
//! The file [`sums`] adds up the six quantities, with their rounding errors if wanted; [`lead`]
//! counts the excess of a step over dt, because its constants are rounded.

mod lead;
mod sums;

use core::ops::{Add, Mul, Neg, Sub};

use crate::bounds::check_step;
use crate::error::{Error, Parameter};
use crate::numbers::{Real, RealOperations};
use crate::pendulum::{Direction, Parameters, State};

pub(crate) use lead::{BLOCK, Lead};
pub(crate) use sums::Sums;

/// Returns sin a1, cos a1, S, C, P1 and P2 of a state, where nu is `norm`, and the units are P1/p1
/// and P2/p2.
pub(crate) fn quantities(state: &State<f64>, norm: f64, [unit1, unit2]: [f64; 2]) -> [f64; 6] {
    let (sin1, cos1) = state.a1.own_sin_cos();
    let (sin_d, cos_d) = (state.a1 - state.a2).own_sin_cos();
    [
        sin1,
        cos1,
        norm * sin_d,
        norm * cos_d,
        state.p1 * unit1,
        state.p2 * unit2,
    ]
}

/// Returns the state of the six quantities, with angles in [-pi, pi]. The lengths of the directions
/// do not matter.
pub(crate) fn state_of(z: [f64; 6], [unit1, unit2]: [f64; 2]) -> State<f64> {
    let [sin1, cos1, s, c, p1, p2] = z;
    let sin2 = sin1 * c - cos1 * s;
    let cos2 = cos1 * c + sin1 * s;
    State {
        a1: libm::atan2(sin1, cos1),
        a2: libm::atan2(sin2, cos2),
        p1: p1 / unit1,
        p2: p2 / unit2,
    }
}

#[inline]
pub(crate) fn directions<R: Real>(z: &[R; 6], norm: R) -> [Direction<R>; 2] {
    let [sin1, cos1, s, c, ..] = *z;
    let inverse = R::ONE / norm;
    let sin2 = sin1 * c - cos1 * s;
    let cos2 = cos1 * c + sin1 * s;
    [[sin1, cos1], [sin2 * inverse, cos2 * inverse]]
}

pub(crate) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
}

impl<N> Number for N where
    N: Copy + Add<Output = N> + Sub<Output = N> + Mul<Output = N> + Neg<Output = N>
{
}

/// Returns u = a1', v = a2', P1' and P2' at `z`, where `r` is 1/(m + S^2), times `share`, which
/// `gravity` already contains.
#[inline(always)] // 2 % fewer cycles on an M3; lanes need it (`flips/lanes.rs`).
pub(crate) fn rates<N: Number>([gravity1, gravity2]: [N; 2], share: N, z: &[N; 6], r: N) -> [N; 4] {
    let [sin1, cos1, s, c, p1, p2] = *z;
    let velocity1 = (p1 - c * p2) * r;
    let velocity2 = p2 - c * velocity1;
    let u = share * velocity1;
    let force = u * velocity2 * s;
    let nu_sin2 = sin1 * c - cos1 * s;
    [
        u,
        share * velocity2,
        -(gravity1 * sin1) - force,
        force - gravity2 * nu_sin2,
    ]
}

/// Returns the rates of change of the six quantities at `z` for the result of [`rates`].
#[inline(always)]
pub(crate) fn changes<N: Number>(z: &[N; 6], [u, v, p1, p2]: [N; 4]) -> [N; 6] {
    let [sin1, cos1, s, c, ..] = *z;
    let w = u - v;
    [cos1 * u, -(sin1 * u), c * w, -(s * w), p1, p2]
}

/// Returns the share by which (s, c) is too short, to first order. `gain` is 1/(2 `length`^2), and
/// `lost` the part of (s^2 + c^2)/2 that rounding has lost.
#[inline(always)]
pub(crate) fn missing<N: Number>([s, c]: [N; 2], length: N, gain: N, lost: N) -> N {
    gain * (((length - c) * (length + c) - s * s) - (lost + lost))
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coefficients<R> {
    pub norm: R,
    pub inertia: R,
    pub gravity: [R; 2],
    pub half_inverse_square: R,
}

impl<R: Real> Coefficients<R> {
    pub fn inverse_at(&self, s: R) -> R {
        R::ONE / (self.inertia + s * s)
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// P1/p1 and P2/p2, s/(kg m^2).
    pub momentum: f64,
    step: f64,
    pub lead: Lead,
}

/// Returns the constants for steps of about `dt` seconds that are `step` units of time long.
///
/// The unit of time follows from G2 as it is rounded, so that the rounding of g to `f32` does not
/// show in the motion. It is up to 2e-6 (`f32`) or 4e-15 (`f64`) of itself too long;
/// [`Scale::lead`] is the excess of `step` units of time over `dt`.
///
/// Refuses, besides parameters and steps, constants that leave the range of `R`, by
/// [`Error::OutOfRange`], which names the step if that alone is at fault.
pub(crate) fn prepare<R: Real>(
    parameters: &Parameters<f64>,
    dt: f64,
    step: f64,
) -> Result<(Coefficients<R>, Scale), Error> {
    parameters.check()?;
    check_step::<R>(dt)?;
    let &Parameters { m1, m2, l1, l2, g } = parameters;
    let norm = l1 / l2;
    let [inertia, total] = [m1, m1 + m2].map(|mass| mass / m2 * norm * norm);

    let unit = dt / libm::rint(step);
    let wanted = unit * unit * g / l1;
    let gravity2 = factor_above::<R>(wanted, total);
    let gravity1 = R::from_f64(total * gravity2.to_f64());
    let time = if g == 0.0 {
        unit
    } else {
        unit * libm::sqrt(gravity2.to_f64() / wanted)
    };

    let rounded_norm = R::from_f64(norm);
    let coefficients = Coefficients {
        norm: rounded_norm,
        inertia: R::from_f64(inertia),
        gravity: [gravity1, gravity2],
        half_inverse_square: R::HALF / (rounded_norm * rounded_norm),
    };
    let scale = Scale {
        momentum: time / (m2 * l2 * l2),
        step,
        lead: Lead::new(time * step, dt),
    };

    let in_range = |constant: R| constant.is_normal() && (R::ONE / constant).is_normal();
    let constants = [coefficients.norm, coefficients.inertia, R::from_f64(total)];
    if !constants.into_iter().all(in_range) {
        return Err(parameters.out_of_range());
    }

    if g == 0.0 || coefficients.gravity.into_iter().all(R::is_normal) {
        Ok((coefficients, scale))
    } else if [g / l1, total * (g / l1)]
        .into_iter()
        .all(|torque| R::from_f64(torque).is_normal())
    {
        Err(Error::OutOfRange {
            parameter: Parameter::Dt,
            value: dt,
        })
    } else {
        Err(parameters.out_of_range())
    }
}

/// Returns the best of the first 32 numbers from `value` upwards: the one whose product with
/// `factor` loses least by rounding.
///
/// G2 may be a little too large, because that only lengthens the unit of time, which is known. The
/// ratio G1/G2 must be exact: where bob 1 is light, the frequency of the fast oscillation depends
/// on the small difference G1 - nu^2 G2.
fn factor_above<R: Real>(value: f64, factor: f64) -> R {
    let lost = |candidate: R| {
        let exact = candidate.to_f64() * factor;
        (R::from_f64(exact).to_f64() - exact).abs()
    };

    let nearest = R::from_f64(value);
    let ulp = nearest * R::EPSILON;
    let least = if nearest.to_f64() < value {
        nearest + ulp
    } else {
        nearest
    };

    let mut best = least;
    let mut least_lost = f64::INFINITY;
    for i in 0..32_i32 {
        let candidate = least + R::from_f64(f64::from(i)) * ulp;
        if lost(candidate) < least_lost {
            best = candidate;
            least_lost = lost(candidate);
        }
    }
    best
}

impl Scale {
    /// Refuses scaled momenta of which one is not finite in `R`, by its value in SI units.
    pub fn check<R: Real>(&self, momenta: [f64; 2]) -> Result<(), Error> {
        for (parameter, p) in [Parameter::P1, Parameter::P2].into_iter().zip(momenta) {
            if !R::from_f64(p).is_finite() {
                return Err(Error::OutOfRange {
                    parameter,
                    value: p / self.momentum,
                });
            }
        }
        Ok(())
    }

    /// Returns the state at the time of `count` steps of dt.
    ///
    /// The motion is at `z` plus `lost`, the last rounding error of `z`. `rates` returns the rates
    /// of change at a point, per unit of time.
    ///
    /// The motion can be ahead of that time, or behind it, by half a step and a little more
    /// ([`Lead::ahead`]). Four stages take it back, each from the slope of the one before: of order
    /// 4 in small oscillations and of order 2 in others.
    #[must_use]
    pub fn state<R: Real>(
        &self,
        // A pointer, so that the rates are compiled once and not in each stage.
        rates: &dyn Fn(&[R; 6]) -> [R; 6],
        z: &[R; 6],
        lost: [R; 6],
        count: u64,
    ) -> State<f64> {
        let span = R::from_f64(-self.lead.ahead(count) * self.step);
        let mut change = [R::ZERO; 6];
        for share in [0.25, 1.0 / 3.0, 0.5, 1.0] {
            let at = core::array::from_fn(|i| z[i] + change[i]);
            change = rates(&at).map(|rate| rate * (span * R::from_f64(share)));
        }

        // A motion that is about to leave the finite numbers is not taken back.
        if !change.into_iter().all(R::is_finite) {
            change = [R::ZERO; 6];
        }

        let exact = core::array::from_fn(|i| z[i].to_f64() + (lost[i] + change[i]).to_f64());
        state_of(exact, [self.momentum; 2])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_constant_is_never_below_its_value() {
        let between = 1.0 + f64::from(f32::EPSILON) / 4.0;
        assert_eq!(factor_above::<f32>(between, 1.0), 1.0 + f32::EPSILON);
        assert_eq!(factor_above::<f32>(1.0, 1.0), 1.0);
    }

    /// Rod 1 turns at a rate of 1, rod 2 is at rest, and p1 grows exponentially. The error is that
    /// of order 4 over the lead: at most 1.5 lead^5/120, for p1. The allowance is a third larger.
    #[test]
    fn state_is_taken_back_by_the_lead() {
        let scale = Scale {
            momentum: 2.0,
            step: 0.5,
            lead: Lead::new(1.01, 1.0),
        };
        let rates = |&[sin1, cos1, s, c, p1, _]: &[f64; 6]| [cos1, -sin1, c, -s, p1, 0.0];
        let [a1, a2] = [0.5, -0.25];
        let elbow = a1 - a2;
        let z = [
            libm::sin(a1),
            libm::cos(a1),
            libm::sin(elbow),
            libm::cos(elbow),
            3.0,
            4.0,
        ];

        let span = 20.0 * (0.01 / 1.01) * 0.5;
        let state = scale.state(&rates, &z, [0.0; 6], 20);
        let expected = [a1 - span, a2, 1.5 * libm::exp(-span), 2.0];
        for (value, expected) in <[f64; 4]>::from(state).into_iter().zip(expected) {
            assert!((value - expected).abs() < span.powi(5) / 60.0, "{state:?}");
        }
    }
}
