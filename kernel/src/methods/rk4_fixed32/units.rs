//! The units of a motion in 32-bit fixed point, and the constants of the equations in these units.
//!
//! [`Units::new`] chooses a unit of time T from the energy of the motion, such that every quantity
//! fits its format and, unless the steps are very short, none is needlessly small. For unlike rods
//! or masses some quantities also get a power of two of their own
//! ([`Shifts`](crate::methods::scaling::Shifts)).
//!
//! Half a step is 3 2^-n T, where n is [`Units::halvings`]. A sixth of a step is then a power of
//! two times T, and the weights of RK4 are exact shifts.

use super::renormalise::RENORMALISE_EVERY;
use crate::bounds::{Bounds, RK4_STABLE, stable_step};
use crate::error::{Error, Parameter};
use crate::methods::scaling::Scaling;
use crate::numbers::fixed::{Gravity, Q30, nearest, scaled};
use crate::pendulum::Parameters;

/// The largest |u| + |v| that the energy at the start may allow, in units of 1/T.
const LARGEST_RATE: f64 = 0.86;

/// The largest torque that the energy at the start may allow.
const LARGEST_TORQUE: f64 = 0.14;

/// The relative growth of the energy above which a motion counts as lost.
const ENERGY_GROWTH: f64 = 0.125;

/// The absolute growth of the energy that is allowed on top, relative to the energy that
/// [`LARGEST_RATE`] stands for. Rounding errors move even a pendulum at rest.
const ENERGY_ROOM: f64 = 1.0 / 64.0;

/// The longest step, relative to the longest unit of time that keeps every quantity in range.
const LONGEST_STEP: f64 = 0.5;

/// The longest step, relative to the time that the elbow of a light bob 1 needs to swing through
/// the peak of r.
const LONGEST_STEP_AT_ELBOW: f64 = 0.5;

pub const MOST_HALVINGS: u32 = 12;

/// The constants that all steps of one motion share, in the units of [`Scaling`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    pub norm: Q30,
    pub inertia: Q30,
    pub gravity: [Gravity; 2],
    /// -G1 and -G2, for the stages that run backwards in time.
    pub reversed_gravity: [Gravity; 2],
    pub halvings: u32,
    /// The decrease of P1 and of P2 in 32 steps that the rounding of G1 and G2 leaves out, with 60
    /// fractional bits: for sin a1 = 1, and for nu sin a2 = 1.
    pub missed: [i32; 2],
    /// nu^2 with 60 fractional bits.
    pub square: i64,
    /// 1/nu^2 with 29 fractional bits.
    pub inverse_square: i64,
    /// The energy above rest beyond which the motion is lost, in the format of `Fixed32::energy`.
    pub most_energy: i64,
    pub scaling: Scaling,
}

/// The units and limits that follow from the energy of a motion.
struct Demands {
    /// The scaling with T = 1 s.
    seconds: Scaling,
    /// The kinetic energy with T = 1 s.
    kinetic: f64,
    /// The bound of (|u| + |v|)^2 in units of twice the kinetic energy.
    sum: f64,
    /// The longest unit of time that keeps rates and torques in range, s.
    longest: f64,
    /// The longest step, s.
    limit: f64,
}

impl Demands {
    fn new(parameters: &Parameters<f64>, energy: f64) -> Result<Self, Error> {
        let &Parameters { m1, m2, .. } = parameters;
        let seconds = Scaling::in_seconds(parameters)?;

        // The kinetic energy, and the bounds of |u| + |v| and of u v S that follow, with T = 1 s.
        let per_joule = seconds.momenta[1] * scaled(1.0, seconds.shifts.lower as i32);
        let kinetic = energy * per_joule;
        let ratio = m1 / m2 * seconds.norm * seconds.norm;
        let sum = 1.0 + (1.0 + seconds.norm) * (1.0 + seconds.norm) / ratio;
        let force = kinetic * libm::sqrt(m2 / m1);
        let largest_gravity = seconds.gravity.into_iter().fold(0.0, f64::max);
        let longest = libm::fmin(
            LARGEST_RATE / libm::sqrt(2.0 * kinetic * sum),
            libm::sqrt(LARGEST_TORQUE / (force + largest_gravity)),
        );

        // A motion of little energy may reach the room's energy unnoticed, so that its step suits
        // twice that. Beyond RK4's limit of stability even the smallest oscillation grows, by up to
        // a factor of a million between two checks of the energy.
        let room = ENERGY_ROOM * LARGEST_RATE * LARGEST_RATE / (2.0 * sum * longest * longest);
        let unnoticed = libm::fmax(energy, 2.0 * room / per_joule);
        let elbow = Bounds::new(parameters, unnoticed).elbow * libm::sqrt(1.0 + m2 / m1);
        let resolved = libm::fmin(LONGEST_STEP * longest, LONGEST_STEP_AT_ELBOW / elbow);
        Ok(Self {
            limit: libm::fmin(resolved, stable_step(parameters, RK4_STABLE)),
            seconds,
            kinetic,
            sum,
            longest,
        })
    }
}

/// Returns the longest step, s, of a motion with `energy` joules above rest.
pub fn longest_step(parameters: &Parameters<f64>, energy: f64) -> Result<f64, Error> {
    Demands::new(parameters, energy).map(|demands| demands.limit)
}

impl Units {
    /// Chooses the units for a motion with `energy` joules above rest and steps of `dt` seconds.
    /// Very short steps are accepted, too, but the numbers then lose digits.
    pub fn new(parameters: &Parameters<f64>, energy: f64, dt: f64) -> Result<Self, Error> {
        let Demands {
            seconds,
            kinetic,
            sum,
            longest,
            limit,
        } = Demands::new(parameters, energy)?;
        let sixth = dt / 6.0;
        let fit = longest / libm::fabs(sixth);
        if fit.is_nan() || libm::fabs(dt) > limit {
            return Err(Error::TooLarge {
                parameter: Parameter::Dt,
                value: dt,
                limit,
            });
        }

        let halvings = libm::ilogb(fit).clamp(0, MOST_HALVINGS as i32) as u32;
        let scaling = seconds.in_unit(scaled(sixth, halvings as i32));
        let gravity = scaling.gravity.map(Gravity::from_f64);
        let reversed_gravity = gravity.map(|gravity| -gravity);

        // The torque that the rounded constants of gravity leave out in 32 steps.
        let block = scaled(f64::from(6 * RENORMALISE_EVERY), 60 - halvings as i32);
        let missed = [0, 1].map(|i| {
            let rounded_off: f64 = gravity[i].missed(scaling.gravity[i]);
            nearest(rounded_off * block) as i32
        });

        let kinetic = kinetic * scaling.time * scaling.time;
        let room = LARGEST_RATE * LARGEST_RATE / (2.0 * sum);
        let most_energy = (1.0 + ENERGY_GROWTH) * kinetic + ENERGY_ROOM * room;
        let shifts = scaling.shifts;
        let places = 60 - (shifts.momentum + shifts.upper + shifts.lower) as i32;

        let square = scaling.norm * scaling.norm;
        Ok(Self {
            norm: Q30::from_f64(scaling.norm),
            inertia: Q30::from_f64(scaling.inertia),
            gravity,
            reversed_gravity,
            halvings,
            missed,
            square: nearest(square * (1_u64 << 60) as f64) as i64,
            inverse_square: nearest((1 << 29) as f64 / square) as i64,
            most_energy: scaled(most_energy, places) as i64,
            scaling,
        })
    }
}
