//! The direction form in 32 bits of fixed point: RK4 for chips without a floating-point unit.

use super::checkpoint::{Check, RestoreError};
use super::equations::{Coefficients, Reverse, Same, Units, turning};
use super::{Direction, Form, lower_direction};
use crate::bounds::Bounds;
use crate::error::{Error, Parameter};
use crate::fixed::{Q30, Scaling, Shifts, Slope, Torque, check_step};
use crate::hamiltonian::Pendulum;
use crate::params::Parameters;
use crate::real::Real;
use crate::ring::Ring;
use crate::sealed::Sealed;
use crate::state::State;
use crate::trig::{Own, SinCos};

/// As [`DirectionForm`](super::DirectionForm), but on integers of 32 bits, 30 of them after the point; the state has 32
/// more, which are carried from step to step. For any masses and rods whose scaled ratios are below some 4,000 (others are refused by name), and any start.
///
/// Rates are counted in a unit of time that the energy of the motion chooses at its start, from the
/// [bounds](crate::Bounds) that no motion of that energy exceeds: every rate and momentum is at most 3/4, torques of gravity
/// 1/4, r at most 1. Numbers below 2 fit, so a stage of RK4 may overshoot by 2.7, and it does not where half a step is at
/// most a quarter of that unit: a longer step is refused with the longest there may be. Whether rates and momenta were
/// below 1 is noted in each step; a motion that once was not, because the steps were too coarse and its energy grew, is
/// lost, its state is NaN and [`try_advance`](Form::try_advance) says so. Nothing is clamped. Unit tests look at each sum
/// and product of 2,000 random lively motions in their coarsest steps: a search, not a proof.
///
/// Error in 10 s of regular motion (0.5 rad, rods of 1 m): 1.2e-8 rad with 256 steps a second, all of it the method's, and
/// 2e-9 with 1024 or more, where compensated `f32` stays at 3e-8 (the repository's tests assert it). Near the upright position
/// and with a heavy bob 2 `f32` is better.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fixed32Form {
    parameters: Parameters<f64>,
    dt: f64,
}

/// A motion in fixed point, with the units that its energy chose: what [`Fixed32Form`] carries from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Fixed32State {
    units: Setting,
    /// sin a1, cos a1, S, C, P1, P2, with 62 bits after the point.
    z: [i64; 6],
    inverse: Q30,
    /// The bits of every rate and momentum since the lengths were restored.
    reach: u32,
    /// Whether one ever was 1 or more, or a length far off.
    lost: bool,
    steps: u64,
}

/// What the steps of one motion have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Setting {
    /// The energy above rest, J, which all of it follows from.
    energy: f64,
    coefficients: Coefficients<Q30>,
    /// The same with time reversed.
    reverse: Coefficients<Q30>,
    shifts: Shifts,
    /// A slope, which has 28 bits, is so many bits more than half a step of it, which has 30.
    half_step: u32,
    /// 2^34 h/(6 T), h being the step.
    weight: i32,
    /// nu^2 with 60 bits after the point, and its inverse with 29.
    square: [i64; 2],
    scaling: Scaling,
    /// What a step is short of dt, in T.
    lag: f64,
}

/// Steps from one restoring of the lengths to the next.
const RESTORING: u32 = 32;

/// The greatest rate and the greatest torque of gravity in the units of the motion.
const RATE: f64 = 0.75;
const TORQUE: f64 = 0.25;

/// Half a step is a quarter of the unit of time or less, ...
const COARSEST: i32 = 2;

/// ... no more than so much of the time in which an elbow bends and is through a light bob 1's peak of r, ...
const RESOLVED: f64 = 0.5;

/// ... and at least this power of a half.
const FINEST: i32 = 20;

/// 1 as the state has it.
const ONE: f64 = (1_u64 << 62) as f64;

/// Half of what the upper words of the state leave out: it is added to the state, so that they are rounded to nearest.
const OFFSET: i64 = 1 << 31;

/// A number of the state.
fn value(z: i64) -> f64 {
    (z - OFFSET) as f64 / ONE
}

impl Fixed32Form {
    fn check(&self) -> Check {
        let Parameters { m1, m2, l1, l2, g } = self.parameters;
        Check::new(32).with_all([m1, m2, l1, l2, g, self.dt].map(f64::to_bits))
    }

    #[inline(never)]
    fn start_from(&self, state: &State<f64>) -> Result<Fixed32State, Error> {
        let energy = Pendulum::new(self.parameters)?.energy_above_rest(state);
        Ok(Setting::new(&self.parameters, energy, self.dt)?.start(state))
    }
}

impl Sealed for Fixed32Form {}

impl<R: Real> Form<R> for Fixed32Form {
    type Carried = Fixed32State;

    fn new(parameters: &Parameters<R>, dt: f64) -> Result<Self, Error> {
        let parameters = parameters.cast::<f64>();
        parameters.check()?;
        check_step(dt)?;
        Ok(Self { parameters, dt })
    }

    fn start(&self, state: &State<R>) -> Result<Self::Carried, Error> {
        state.check()?;
        self.start_from(&state.cast())
    }

    // A call is nothing beside such a step, and a chip's flash holds it once.
    #[inline(never)]
    fn advance(&self, carried: &mut Self::Carried, steps: u32) {
        let mut left = steps;
        while left > 0 {
            let until_restoring = RESTORING - carried.steps as u32 % RESTORING;
            let run = left.min(until_restoring);
            if carried.units.shifts == Shifts::default() {
                carried.advance(&Same, run);
            } else {
                let shifts = carried.units.shifts;
                carried.advance(&shifts, run);
            }
            carried.steps += u64::from(run);
            left -= run;
            if run == until_restoring {
                carried.restore_lengths();
            }
        }
    }

    fn directions(&self, carried: &Self::Carried) -> [Direction<R>; 2] {
        let [sin1, cos1, s, c, ..] = carried.z.map(|z| R::from_f64(value(z)));
        [[sin1, cos1], lower_direction([sin1, cos1], [s, c], R::from_f64(carried.units.scaling.norm))]
    }

    fn state(&self, carried: &Self::Carried) -> State<f64> {
        carried.state()
    }

    fn bits(carried: &Self::Carried, mut feed: impl FnMut(u64)) {
        carried.z.iter().for_each(|&z| feed(z as u64));
        feed(carried.inverse.0 as u64);
        feed(u64::from(carried.reach) | u64::from(carried.lost) << 32);
        feed(carried.steps);
    }

    type Saved = [u64; 11];

    fn save(&self, carried: &Self::Carried) -> Self::Saved {
        self.check().save(|feed| {
            feed(carried.units.energy.to_bits());
            <Self as Form<R>>::bits(carried, feed);
        })
    }

    fn restore(&self, saved: &[u64]) -> Result<Self::Carried, RestoreError> {
        let mut words = self.check().open::<11>(saved)?;
        let energy = f64::from_bits(words.word()?);
        let units = Setting::new(&self.parameters, energy, self.dt).map_err(|_| RestoreError::NotSavedHere)?;
        let z = words.each(|words| Ok(words.word()? as i64))?;
        let inverse = Q30(words.word()? as i32);
        let reached = words.word()?;
        Ok(Fixed32State { units, z, inverse, reach: reached as u32, lost: reached >> 32 != 0, steps: words.word()? })
    }
}

impl Setting {
    /// For a motion of `energy` J above rest.
    #[inline(never)]
    fn new(parameters: &Parameters<f64>, energy: f64, dt: f64) -> Result<Self, Error> {
        let bounds = Bounds::new(parameters, energy);
        let half = 0.5 * dt;
        let mut halvings = 0;
        let mut scaling = Scaling::new(parameters, &bounds, [RATE, TORQUE], |[by_rates, by_torques]| {
            let longest = libm::fmin(by_rates, by_torques);
            let fit = libm::floor(libm::log2(longest / libm::fabs(half)));
            let resolved = RESOLVED / (bounds.elbow * libm::sqrt(1.0 + parameters.m2 / parameters.m1));
            let limit = libm::fmin(libm::scalbn(longest, 1 - COARSEST), resolved);
            if fit.is_nan() || libm::fabs(dt) > limit {
                return Err(Error::TooLarge { parameter: Parameter::Dt, value: dt, limit });
            }
            halvings = libm::fmin(fit, f64::from(FINEST)) as i32;
            Ok(libm::scalbn(half, halvings))
        })?;
        scaling.round_gravity(f64::from(1 << 30));
        let third = libm::rint(libm::scalbn(1.0 / 3.0, 34 - halvings));
        let advanced = 6.0 * libm::scalbn(third, -34);
        let norm = scaling.norm;
        let coefficients = Coefficients {
            norm: Q30::constant(norm),
            inertia: Q30::constant(scaling.inertia),
            gravity: scaling.gravity.map(Q30::constant),
        };
        Ok(Self {
            energy,
            coefficients,
            reverse: Coefficients { gravity: coefficients.gravity.map(|gravity| -gravity), ..coefficients },
            shifts: scaling.shifts,
            half_step: (halvings - COARSEST) as u32,
            weight: third as i32,
            square: [
                libm::rint(norm * norm * (1_u64 << 60) as f64) as i64,
                libm::rint((1 << 29) as f64 / (norm * norm)) as i64,
            ],
            lag: dt / scaling.time - advanced,
            scaling,
        })
    }
}

impl Setting {
    /// The motion that starts from `state`, of the energy it is for or less.
    fn start(&self, state: &State<f64>) -> Fixed32State {
        let State { a1, a2, p1, p2 } = *state;
        let (sin1, cos1) = Own::sin_cos(a1);
        let (sin_d, cos_d) = Own::sin_cos(a1 - a2);
        let Scaling { norm, momenta: [unit1, unit2], .. } = self.scaling;
        let z = [sin1, cos1, norm * sin_d, norm * cos_d, p1 * unit1, p2 * unit2];
        let denominator = self.scaling.denominator(z[2]);
        Fixed32State {
            units: *self,
            z: z.map(|z| libm::rint(z * ONE) as i64 + OFFSET),
            inverse: Q30::constant(1.0 / denominator),
            reach: 0,
            lost: false,
            steps: 0,
        }
    }
}

impl Fixed32State {
    /// The motion that starts from `state`, whose energy is at most this one's: in the same units.
    pub(super) fn start<R: Real>(&self, state: &State<R>) -> Result<Self, Error> {
        state.check()?;
        Ok(self.units.start(&state.cast()))
    }

    /// sin a1, cos a1, S, C, P1, P2, rounded.
    #[inline(always)]
    pub(super) fn quantities(&self) -> [Q30; 6] {
        self.z.map(|z| Q30((z >> 32) as i32))
    }

    fn advance(&mut self, units: &impl Units<Q30>, steps: u32) {
        for _ in 0..steps {
            self.step(units);
        }
    }

    #[inline(always)]
    fn step(&mut self, units: &impl Units<Q30>) {
        let Setting { coefficients, reverse, half_step, weight, .. } = &self.units;
        let z = self.quantities();
        let inverse = self.inverse;
        let rates = |z: &[Q30; 6], r: Q30| {
            let &[sin1, cos1, s, c, p1, p2] = z;
            coefficients.rates(units, [sin1, cos1], [s, c], [p1, p2], r)
        };
        let reversed = |z: &[Q30; 6], r: Q30| {
            let &[sin1, cos1, s, c, p1, p2] = z;
            reverse.rates(&Reverse(*units), [sin1, cos1], [s, c], [p1, p2], r)
        };
        // half a step of the slopes
        let half = |turns: [Slope; 4], torques: [Torque; 2]| {
            let ([sin1, cos1, s, c], [p1, p2]) = (turns, torques.map(|torque| Slope((torque.0 >> 32) as i32)));
            [sin1, cos1, s, c, p1, p2].map(|slope| Q30(slope.0 >> half_step))
        };
        // the inverse where the elbow has changed by `change`, of which the rate was found at `s`: it falls by 2 S S' r^2
        let follow = |change: Q30, s: Q30, r: Q30| inverse - units.inverse(change.twice() * (s * r)) * r;

        let at_start = rates(&z, inverse);
        let ([u, v], [turn1, turn2]) = (at_start.own, at_start.angles);
        for x in [u, v, turn1 - turn2, z[4], z[5]] {
            self.reach |= (x.0 ^ (x.0 >> 31)) as u32;
        }
        // Turns are rounded down. Every second slope is taken backwards, so that as many are rounded up.
        let (turns1, torques1) = (turning(&z, at_start.angles), at_start.momenta);
        let change = half(turns1, torques1);
        let z2: [Q30; 6] = core::array::from_fn(|i| z[i] + change[i]);
        let r2 = follow(change[2], z[2], inverse);

        let rates2 = reversed(&z2, r2);
        let (turns2, torques2) = (turning(&z2, rates2.angles), rates2.momenta);
        let change = half(turns2, torques2);
        let z3: [Q30; 6] = core::array::from_fn(|i| z[i] - change[i]);
        let r3 = follow(-change[2], z2[2], r2);

        let rates3 = rates(&z3, r3);
        let (turns3, torques3) = (turning(&z3, rates3.angles), rates3.momenta);
        let middle: [Slope; 4] = core::array::from_fn(|i| turns3[i] - turns2[i]);
        let middle_torques: [Torque; 2] = core::array::from_fn(|i| torques3[i] - torques2[i]);
        let change = half(turns3.map(|k| k + k), torques3.map(|k| k + k));
        let z4: [Q30; 6] = core::array::from_fn(|i| z[i] + change[i]);
        let r4 = follow(change[2], z3[2], r3);

        let rates4 = reversed(&z4, r4);
        let (turns4, torques4) = (turning(&z4, rates4.angles), rates4.momenta);
        for i in 0..4 {
            let sum = (turns1[i] - turns4[i]) + middle[i] + middle[i];
            self.z[i] = self.z[i].wrapping_add(i64::from(sum.0) * i64::from(*weight));
        }
        for i in 0..2 {
            let Torque(sum) = (torques1[i] - torques4[i]) + middle_torques[i] + middle_torques[i];
            let low = u64::from(sum as u32) * u64::from(*weight as u32);
            let change = (sum >> 32) * i64::from(*weight) + (low >> 32) as i64;
            self.z[4 + i] = self.z[4 + i].wrapping_add(change);
        }
        let s = Q30((self.z[2] >> 32) as i32);
        let missing = (Q30(1 << 30) - coefficients.inertia * r4) - units.inverse((s * r4) * s);
        self.inverse = r4 + r4 * missing;
    }

    /// Makes sin^2 a1 + cos^2 a1 = 1 and S^2 + C^2 = nu^2 again, to first order in what they miss, and asks whether
    /// anything was out of range.
    fn restore_lengths(&mut self) {
        let [square, inverse_square] = self.units.square;
        for (first, square, gain) in [(0, 1 << 60, 1 << 29), (2, square, inverse_square)] {
            let [s, c] = [self.z[first] - OFFSET, self.z[first + 1] - OFFSET];
            let part = |z: i64| ((z >> 32) * (z >> 32), ((z >> 32) * (z & 0xffff_ffff)) >> 31);
            let ((s2, s_more), (c2, c_more)) = (part(s), part(c));
            let missing = square - s2 - c2 - s_more - c_more;
            if missing.unsigned_abs() >= 1 << 51 {
                self.lost = true;
                return;
            }
            let relative = ((missing >> 20) * gain) >> 29;
            for z in &mut self.z[first..first + 2] {
                *z = z.wrapping_add((*z >> 32).wrapping_mul(relative) >> 9);
            }
        }
        self.lost |= self.reach >= 1 << 30;
        self.reach = 0;
    }

    #[inline(never)]
    fn state(&self) -> State<f64> {
        let Setting { scaling, lag, coefficients, shifts, .. } = &self.units;
        if self.lost || self.reach >= 1 << 30 {
            return State { a1: f64::NAN, a2: f64::NAN, p1: f64::NAN, p2: f64::NAN };
        }
        let [sin1, cos1, s, c, p1, p2] = self.z.map(value);
        let [sin2, cos2] = lower_direction([sin1, cos1], [s, c], scaling.norm);
        let [sin_q, cos_q, s_q, c_q, p1_q, p2_q] = self.z.map(|z| Q30((z >> 32) as i32));
        let rates = coefficients.rates(shifts, [sin_q, cos_q], [s_q, c_q], [p1_q, p2_q], self.inverse);
        let behind = self.steps as f64 * lag;
        let [u, v] = rates.angles.map(|rate| f64::from(rate.0) / f64::from(1 << 30) * behind);
        let [f1, f2] = rates.momenta.map(|rate| rate.0 as f64 / (1_u64 << 60) as f64 * behind);
        let [unit1, unit2] = scaling.momenta;
        State {
            a1: libm::atan2(sin1, cos1) + u,
            a2: libm::atan2(sin2, cos2) + v,
            p1: (p1 + f1) / unit1,
            p2: (p2 + f2) / unit2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in (-1, 1), the same in every run (G. Marsaglia's xorshift).
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// A motion in the coarsest steps that its energy allows.
    fn coarsest(parameters: &Parameters<f64>, state: &State<f64>) -> Result<Fixed32State, Error> {
        let energy = Pendulum::new(*parameters)?.energy_above_rest(state);
        let dt = match Setting::new(parameters, energy, 1e6) {
            Err(Error::TooLarge { limit, .. }) => 0.999_999 * limit,
            other => return Err(other.map_or_else(|error| error, |_| parameters.out_of_range())),
        };
        let form = <Fixed32Form as Form<f64>>::new(parameters, dt)?;
        form.start(state)
    }

    fn parameters(random: &mut Random, most: f64) -> Parameters<f64> {
        let mut power = || libm::exp2(most * random.next());
        Parameters { m1: power(), m2: power(), l1: power(), l2: power(), g: 9.81 }
    }

    /// The largest of the rates and momenta so far, as the motion knows it.
    fn reach(motion: &Fixed32State) -> f64 {
        f64::from(motion.reach) / f64::from(1 << 30)
    }

    /// Every sum and product of each step is looked at (`word`, `fits`): none may leave its range.
    #[test]
    fn no_motion_that_its_energy_allows_leaves_the_range() -> Result<(), Error> {
        let mut random = Random(1);
        for _ in 0..2000 {
            let parameters = parameters(&mut random, 2.5);
            let wild = libm::exp2(3.0 * random.next());
            let momentum = wild * parameters.m2 * parameters.l2 * libm::sqrt(parameters.l2);
            let [a1, a2, p1, p2] = [3.2, 3.2, momentum, momentum].map(|most| most * random.next());
            let mut motion = coarsest(&parameters, &State { a1, a2, p1, p2 })?;
            let form = <Fixed32Form as Form<f64>>::new(&parameters, 1.0)?;
            for _ in 0..200 {
                Form::<f64>::advance(&form, &mut motion, 1);
                if motion.lost || reach(&motion) >= 1.0 {
                    break;
                }
            }
        }
        Ok(())
    }

    /// All of the energy kinetic, and a fifth more, in any direction of the momenta and at any angles: more than the bounds
    /// allow. No step from there may leave the range of any sum or product.
    #[test]
    fn no_step_with_all_the_energy_in_it_leaves_the_range() -> Result<(), Error> {
        const MORE: f64 = 1.2;
        let mut random = Random(2);
        let mut largest = 0.0;
        for _ in 0..50_000 {
            let parameters = parameters(&mut random, 2.5);
            let pendulum = Pendulum::new(parameters)?;
            let start = State::at_rest(3.2 * random.next(), 3.2 * random.next());
            let mut motion = coarsest(&parameters, &start)?;
            let norm = motion.units.scaling.norm;
            let [a1, a2] = [3.2 * random.next(), 3.2 * random.next()];
            let (p1, p2) = (random.next() * parameters.l1, random.next() * parameters.l2);
            let still = pendulum.energy_above_rest(&State::at_rest(a1, a2));
            let kinetic = pendulum.energy_above_rest(&State { a1, a2, p1, p2 }) - still;
            let times = libm::sqrt(MORE * pendulum.energy_above_rest(&start) / kinetic);
            let [unit1, unit2] = motion.units.scaling.momenta;
            let (sin1, cos1) = libm::sincos(a1);
            let (sin_d, cos_d) = libm::sincos(a1 - a2);
            let z = [sin1, cos1, norm * sin_d, norm * cos_d, p1 * times * unit1, p2 * times * unit2];
            motion.z = z.map(|z| libm::rint(z * ONE) as i64 + OFFSET);
            motion.inverse = Q30::constant(1.0 / motion.units.scaling.denominator(z[2]));
            let shifts = motion.units.shifts;
            motion.advance(&shifts, 1);
            largest = libm::fmax(largest, reach(&motion));
        }
        assert!((0.8..1.0).contains(&largest), "as large as can be, and accepted: {largest}");
        Ok(())
    }
}
