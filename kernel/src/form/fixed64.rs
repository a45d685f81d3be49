//! The direction form in 64 bits of fixed point, by extrapolation: many digits for chips without a unit for them.

use super::checkpoint::{Check, RestoreError};
use super::equations::{Coefficients, Same, Units};
use super::extrapolated::PacedExtrapolation;
use super::{Direction, Form, lower_direction};
use crate::bounds::Bounds;
use crate::error::{Error, Parameter};
use crate::fixed::{Q60, Scaling, Shifts, check_step};
use crate::hamiltonian::Pendulum;
use crate::params::Parameters;
use crate::real::Real;
use crate::ring::Ring;
use crate::sealed::Sealed;
use crate::state::State;
use crate::trig::{Own, SinCos};

/// As [`ExtrapolatedForm`](super::ExtrapolatedForm), but on integers of 64 bits, 60 of them after the point. For any masses
/// and rods whose ratios are below some 1000, and any start.
///
/// As in [`Fixed32Form`](super::Fixed32Form) the energy of the motion chooses a unit of time: every rate is at most 1/2
/// in it, and factors fit below 2. A step longer than 7/4 of it is refused; a motion whose lengths, r or momenta a step led
/// astray is lost, its state is NaN and [`try_advance`](Form::try_advance) says so.
///
/// Error in 10 s of regular motion (0.5 rad, rods of 1 m) by order 12: below 1e-12 rad with 12 steps a second; chaotic, as
/// much as in `f64` down to 1e-12 rad (the repository's tests assert it).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fixed64Form<const ORDER: u32> {
    parameters: Parameters<f64>,
    dt: f64,
}

/// A motion in fixed point, with the units that its energy chose: what [`Fixed64Form`] carries from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fixed64State {
    method: PacedExtrapolation<Q60>,
    scaling: Scaling,
    coefficients: Coefficients<Q60>,
    /// 1/(4 nu^2).
    quarter_inverse_square: Q60,
    /// sin a1, cos a1, S, C, P1, P2, r.
    z: [Q60; 7],
    lost: bool,
    /// The energy above rest, J, which the units follow from.
    energy: f64,
}

/// The greatest rate, the greatest torque of gravity, and the longest step in the units of the motion.
const RATE: f64 = 0.5;
const TORQUE: f64 = 0.25;
const STEP: f64 = 1.75;

/// The longest unit of time, in steps.
const LONGEST: f64 = (1 << 20) as f64;

/// 1 as the state has it.
const ONE: f64 = (1_u64 << 60) as f64;

/// By how much a step may alter the square of a length.
const LENGTH: u64 = 1 << 52;

/// What no momentum exceeds: twice what the energy allows.
const MOMENTUM: u64 = 1 << 60;

impl<const ORDER: u32> Fixed64Form<ORDER> {
    fn check(&self) -> Check {
        let Parameters { m1, m2, l1, l2, g } = self.parameters;
        Check::new(64 + (u64::from(ORDER) << 32)).with_all([m1, m2, l1, l2, g, self.dt].map(f64::to_bits))
    }
}

impl<const ORDER: u32> Sealed for Fixed64Form<ORDER> {}

impl<R: Real, const ORDER: u32> Form<R> for Fixed64Form<ORDER> {
    type Carried = Fixed64State;

    fn new(parameters: &Parameters<R>, dt: f64) -> Result<Self, Error> {
        let parameters = parameters.cast::<f64>();
        parameters.check()?;
        check_step(dt)?;
        Ok(Self { parameters, dt })
    }

    fn start(&self, state: &State<R>) -> Result<Self::Carried, Error> {
        state.check()?;
        Fixed64State::start(&self.parameters, self.dt, ORDER, &state.cast())
    }

    #[inline]
    fn advance(&self, carried: &mut Self::Carried, steps: u32) {
        carried.advance(steps);
    }

    fn directions(&self, carried: &Self::Carried) -> [Direction<R>; 2] {
        let [sin1, cos1, s, c, ..] = carried.z.map(|z| R::from_f64(z.0 as f64 / ONE));
        [[sin1, cos1], lower_direction([sin1, cos1], [s, c], R::from_f64(carried.scaling.norm))]
    }

    fn state(&self, carried: &Self::Carried) -> State<f64> {
        carried.state()
    }

    fn bits(carried: &Self::Carried, mut feed: impl FnMut(u64)) {
        carried.z.iter().for_each(|&z| feed(z.0 as u64));
        feed(u64::from(carried.lost));
    }

    type Saved = [u64; 10];

    fn save(&self, carried: &Self::Carried) -> Self::Saved {
        self.check().save(|feed| {
            feed(carried.energy.to_bits());
            <Self as Form<R>>::bits(carried, feed);
        })
    }

    fn restore(&self, saved: &[u64]) -> Result<Self::Carried, RestoreError> {
        let mut words = self.check().open::<10>(saved)?;
        let energy = f64::from_bits(words.word()?);
        let z = words.each(|words| Ok(Q60(words.word()? as i64)))?;
        let lost = words.word()? != 0;
        let new = Fixed64State::new(&self.parameters, energy, self.dt, ORDER);
        Ok(Fixed64State { z, lost, ..new.map_err(|_| RestoreError::NotSavedHere)? })
    }
}

impl Fixed64State {
    #[inline(never)]
    fn start(parameters: &Parameters<f64>, dt: f64, order: u32, state: &State<f64>) -> Result<Self, Error> {
        let energy = Pendulum::new(*parameters)?.energy_above_rest(state);
        let motion = Self::new(parameters, energy, dt, order)?;
        let &State { a1, a2, p1, p2 } = state;
        let (sin1, cos1) = Own::sin_cos(a1);
        let (sin_d, cos_d) = Own::sin_cos(a1 - a2);
        let Scaling { norm, momenta: [unit1, unit2], .. } = motion.scaling;
        let inverse = 1.0 / motion.scaling.denominator(norm * sin_d);
        let z = [sin1, cos1, norm * sin_d, norm * cos_d, p1 * unit1, p2 * unit2, inverse];
        Ok(Self { z: z.map(Q60::constant), ..motion })
    }

    /// At no place yet, for motions of `energy` J above rest.
    fn new(parameters: &Parameters<f64>, energy: f64, dt: f64, order: u32) -> Result<Self, Error> {
        let bounds = Bounds::new(parameters, energy);
        let scaling = Scaling::new(parameters, &bounds, [RATE, TORQUE], |longest| {
            let limit = STEP * longest;
            if libm::fabs(dt) > limit {
                return Err(Error::TooLarge { parameter: Parameter::Dt, value: dt, limit });
            }
            Ok(libm::copysign(libm::fmin(longest, LONGEST * libm::fabs(dt)), dt))
        })?;
        let norm = scaling.norm;
        let coefficients = Coefficients {
            norm: Q60::constant(norm),
            inertia: Q60::constant(scaling.inertia),
            gravity: scaling.gravity.map(Q60::constant),
        };
        let step = dt / scaling.time;
        Ok(Self {
            method: PacedExtrapolation::new(order, step, coefficients, scaling.gravity)?,
            scaling,
            coefficients,
            quarter_inverse_square: Q60::constant(0.25 / (norm * norm)),
            z: [Q60(0); 7],
            energy,
            lost: false,
        })
    }

    #[inline(never)]
    fn advance(&mut self, steps: u32) {
        let shifts = self.scaling.shifts;
        for _ in 0..steps {
            if shifts == Shifts::default() { self.step(&Same) } else { self.step(&shifts) }
        }
    }

    fn step(&mut self, units: &impl Units<Q60>) {
        let change = self.method.increment(units, &self.z);
        let z: [Q60; 7] = core::array::from_fn(|i| self.z[i] + change[i]);
        let [sin1, cos1, s, c, p1, p2, r] = z;
        let ([sin1, cos1], missing1) = restored([sin1, cos1], Q60::constant(1.0), Q60::constant(0.25));
        let norm = self.coefficients.norm;
        let ([s, c], missing2) = restored([s, c], norm * norm, self.quarter_inverse_square);
        let missing = (Q60::constant(1.0) - self.coefficients.inertia * r) - units.inverse(s * r * s);
        self.lost |= [missing1, missing2, missing].into_iter().any(|missing| missing.0.unsigned_abs() > LENGTH)
            || [p1, p2].into_iter().any(|p| p.0.unsigned_abs() > MOMENTUM);
        self.z = [sin1, cos1, s, c, p1, p2, r + r * missing];
    }

    #[inline(never)]
    fn state(&self) -> State<f64> {
        if self.lost {
            return State { a1: f64::NAN, a2: f64::NAN, p1: f64::NAN, p2: f64::NAN };
        }
        let [sin1, cos1, s, c, p1, p2, _] = self.z.map(|z| z.0 as f64 / ONE);
        let [sin2, cos2] = lower_direction([sin1, cos1], [s, c], self.scaling.norm);
        let [unit1, unit2] = self.scaling.momenta;
        State { a1: libm::atan2(sin1, cos1), a2: libm::atan2(sin2, cos2), p1: p1 / unit1, p2: p2 / unit2 }
    }
}

/// The direction with its length restored to first order in what it misses, and what that was.
#[inline(always)]
fn restored([s, c]: [Q60; 2], square: Q60, gain: Q60) -> ([Q60; 2], Q60) {
    let missing = square - s * s - c * c;
    let relative = (missing * gain).twice();
    ([s + s * relative, c + c * relative], missing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_leaves_the_range() -> Result<(), Error> {
        let parameters = Parameters::equal_rods(1.0, 1.0, 9.81);
        for angle in [0.5, 1.0, 2.0, 2.094, 3.0] {
            let form = <Fixed64Form<12> as Form<f64>>::new(&parameters, 1.0 / 60.0)?;
            let mut carried = Form::<f64>::start(&form, &State::at_rest(angle, angle))?;
            Form::<f64>::advance(&form, &mut carried, 600);
            assert!(!carried.lost, "{angle}");
        }
        Ok(())
    }
}
