//! What the steps of one motion have in common: its units and constants.

use super::RENORMALISE_EVERY;
use crate::bounds::Bounds;
use crate::error::{Error, Parameter};
use crate::methods::scaling::Scaling;
use crate::numbers::Scalar;
use crate::numbers::fixed::{Gravity, Q30, nearest, scaled};
use crate::pendulum::Parameters;
use crate::pendulum::directions::Coefficients;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Setting {
    pub coefficients: Coefficients<Q30, Gravity>,
    /// The same with time reversed.
    pub reverse: Coefficients<Q30, Gravity>,
    /// Half a step is 3 2^-n T.
    pub halvings: u32,
    /// What the words of G1 and G2 miss, times 32 steps, with 60 bits after the point.
    pub missed: [i32; 2],
    /// nu^2 with 60 bits after the point, and its inverse with 29.
    pub square: [i64; 2],
    /// The greatest energy in the units of [`Fixed32::energy`](super::Fixed32::energy).
    pub most_energy: i64,
    pub scaling: Scaling,
}

/// The greatest |u| + |v| at the start, and the greatest torque, in the units of the motion.
const RATE: f64 = 0.86;
const TORQUE: f64 = 0.14;

/// The energy may grow by so much of itself, ...
const GROWTH: f64 = 0.125;
/// ... and by so much of what goes with [`RATE`]: roundings move a pendulum at rest.
const ROOM: f64 = 1.0 / 64.0;

/// A step is so much of the longest unit of time that there may be, or less, ...
const COARSEST: f64 = 0.5;

/// ... no more than so much of the time in which an elbow bends and is through a light bob 1's peak of r, ...
const RESOLVED: f64 = 0.5;

/// Half a step is at least three times this power of a half.
const FINEST: u32 = 12;

impl Setting {
    /// For a motion of `energy` J above rest.
    #[inline(never)]
    pub fn new(parameters: &Parameters<f64>, energy: f64, dt: f64) -> Result<Self, Error> {
        let seconds = Scaling::in_seconds(parameters)?;
        // K, the greatest |u| + |v| and the greatest u v S by that K, in units with T = 1 s
        let kinetic = energy * seconds.momenta[1] * scaled(1.0, seconds.shifts.lower as i32);
        let ratio = parameters.m1 / parameters.m2 * seconds.norm * seconds.norm;
        let sum = 1.0 + (1.0 + seconds.norm) * (1.0 + seconds.norm) / ratio;
        let force = kinetic * libm::sqrt(parameters.m2 / parameters.m1);
        let longest = libm::fmin(
            RATE / libm::sqrt(2.0 * kinetic * sum),
            libm::sqrt(TORQUE / (force + seconds.gravity.into_iter().fold(0.0, f64::max))),
        );

        let elbow =
            Bounds::new(parameters, energy).elbow * libm::sqrt(1.0 + parameters.m2 / parameters.m1);
        let limit = libm::fmin(COARSEST * longest, RESOLVED / elbow);
        let sixth = dt / 6.0;
        let fit = libm::floor(libm::log2(longest / libm::fabs(sixth)));
        if fit.is_nan() || libm::fabs(dt) > limit {
            return Err(Error::TooLarge {
                parameter: Parameter::Dt,
                value: dt,
                limit,
            });
        }
        let halvings = libm::fmin(fit, f64::from(FINEST)) as u32;
        let scaling = seconds.in_unit(scaled(sixth, halvings as i32));
        let gravity = scaling.gravity.map(Gravity::from_f64);
        let run = scaled(f64::from(6 * RENORMALISE_EVERY), 60 - halvings as i32);
        let missed = |i: usize| nearest(gravity[i].missed(scaling.gravity[i]) * run) as i32;
        let norm = scaling.norm;
        let coefficients = Coefficients {
            norm: Q30::from_f64(norm),
            inertia: Q30::from_f64(scaling.inertia),
            gravity,
        };
        let energy_unit = scaled(
            1.0,
            60 - (scaling.shifts.momentum + scaling.shifts.upper) as i32,
        ) / scaled(1.0, scaling.shifts.lower as i32);
        let most_energy = (1.0 + GROWTH) * kinetic * scaling.time * scaling.time
            + ROOM * RATE * RATE / (2.0 * sum);
        Ok(Self {
            coefficients,
            reverse: Coefficients {
                gravity: coefficients.gravity.map(|gravity| -gravity),
                ..coefficients
            },
            halvings,
            missed: [0, 1].map(missed),
            square: [
                nearest(norm * norm * (1_u64 << 60) as f64) as i64,
                nearest((1 << 29) as f64 / (norm * norm)) as i64,
            ],
            most_energy: (most_energy * energy_unit) as i64,
            scaling,
        })
    }
}
