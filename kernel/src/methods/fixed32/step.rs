//! A step of RK4 in words of 32 bits; and what is done every few steps: lengths are restored, gravity's last digits are made up
//! for, the energy is looked at.

use super::setting::Setting;
use super::{Fixed32, OFFSET};
use crate::methods::scaling::{Paced, Shifts};
use crate::numbers::Scalar;
use crate::numbers::fixed::{IN_HALVES, Q30, Slope, Torque, product, word};
use crate::pendulum::directions::{Rates, Units, turning};

/// Whether to compile the step once for every usual length, with shifts that cost nothing. A chip with a floating-point unit
/// has a faster form and better use for its flash.
const SPECIALISED: bool = !cfg!(target_abi = "eabihf");

/// By how much the square of a length may be off, with 60 bits after the point.
const LENGTH: u64 = 1 << 51;

/// The word times 2^`by`, `by` being from 1 to 31.
#[inline(always)]
fn shifted(word: i32, by: u32) -> i64 {
    i64::from(word >> (32 - by)) << 32 | i64::from((word as u32) << by)
}

impl Fixed32 {
    /// Makes `steps` steps without renormalising.
    pub(super) fn make(&mut self, steps: u32) {
        let shifts = self.units.scaling.shifts;
        if !SPECIALISED {
            self.run(shifts, self.units.halvings, steps);
        } else if shifts == Shifts::NONE {
            self.run_specialised(Shifts::NONE, steps);
        } else {
            self.run_specialised(shifts, steps);
        }
    }

    #[inline(always)]
    fn run_specialised(&mut self, units: Shifts, steps: u32) {
        match self.units.halvings {
            halvings if IN_HALVES => self.run(units, halvings, steps),
            3 => self.run(units, 3, steps),
            4 => self.run(units, 4, steps),
            5 => self.run(units, 5, steps),
            6 => self.run(units, 6, steps),
            halvings => self.run(units, halvings, steps),
        }
    }

    #[inline(always)]
    fn run(&mut self, units: Shifts, halvings: u32, steps: u32) {
        for _ in 0..steps {
            self.step(units, halvings);
        }
    }

    #[inline(always)]
    fn step(&mut self, units: Shifts, halvings: u32) {
        let Setting {
            coefficients,
            reverse,
            ..
        } = &self.units;
        let z = self.quantities();
        let inverse = self.inverse;
        let slopes = |z: &[Q30; 6], rates: Rates<Q30>| (turning(z, rates.angles), rates.momenta);
        // half a step of a rate of change, or a whole one with one halving less
        let moved = |turns: [Slope; 4], torques: [Torque; 2], halvings: u32| {
            let [sin1, cos1, s, c] = turns.map(|k| Q30((k + k + k).0 >> (halvings - 2)));
            let [p1, p2] = torques.map(|k| Q30((k + k + k).0 >> (halvings + 1)));
            [sin1, cos1, s, c, p1, p2]
        };
        // Half of -r' = 2 S S' r^2. S r is 2^(i/2) at most where r is 2^i, so half of i goes where there is room for it, the
        // rest to what r changes in half a step.
        let half_up = units.inverse / 2;
        let half_fall = |s_rate: Slope, s: Q30, r: Q30| {
            (s_rate.number() * (s * r))
                .up(half_up)
                .down(units.momentum)
                .slope(r)
        };
        let fallen = |k: Slope| Q30((k + k + k).0 >> (halvings - 3)).up(units.inverse - half_up);

        // All is rounded down. Every second slope is taken backwards in time, with reversed momenta, so that as much is
        // rounded up.
        let (turns1, torques1) =
            slopes(&z, coefficients.rates(&Paced::<false>(units), &z, inverse));
        let [sin1, cos1, s, c, p1, p2] = moved(turns1, torques1, halvings);
        let z2 = [
            z[0] + sin1,
            z[1] + cos1,
            z[2] + s,
            z[3] + c,
            -z[4] - p1,
            -z[5] - p2,
        ];
        let fall1 = half_fall(turns1[2], z[2], inverse);
        let r2 = inverse - fallen(fall1);

        let (turns2, torques2) = slopes(&z2, reverse.rates(&Paced::<true>(units), &z2, r2));
        let change = moved(turns2, torques2, halvings);
        let z3: [Q30; 6] = core::array::from_fn(|i| z[i] - change[i]);
        let fall2 = half_fall(turns2[2], z2[2], r2);
        let r3 = inverse + fallen(fall2);

        let (turns3, torques3) = slopes(&z3, coefficients.rates(&Paced::<false>(units), &z3, r3));
        let middle: [Slope; 4] = core::array::from_fn(|i| turns3[i] - turns2[i]);
        let middle_torques: [Torque; 2] = core::array::from_fn(|i| torques3[i] - torques2[i]);
        let [sin1, cos1, s, c, p1, p2] = moved(turns3, torques3, halvings - 1);
        let z4 = [
            z[0] + sin1,
            z[1] + cos1,
            z[2] + s,
            z[3] + c,
            -z[4] - p1,
            -z[5] - p2,
        ];
        let fall3 = half_fall(turns3[2], z3[2], r3);
        let r4 = inverse - fallen(fall3).twice();

        let (turns4, torques4) = slopes(&z4, reverse.rates(&Paced::<true>(units), &z4, r4));
        for i in 0..4 {
            let sum = (turns1[i] - turns4[i]) + middle[i] + middle[i];
            self.z[i] += shifted(sum.0, 34 - halvings);
        }
        for i in 0..2 {
            let sum = (torques1[i] - torques4[i]) + middle_torques[i] + middle_torques[i];
            self.z[4 + i] += shifted(sum.0, 31 - halvings);
        }
        let s = self.quantities()[2];
        self.inverse = r4.inverse_of(coefficients.inertia, s, &units);
    }

    #[inline(never)]
    pub(super) fn renormalise(&mut self) {
        self.restore_lengths();
        self.make_up_for_gravity();
        self.lost |= self.energy() > self.units.most_energy;
    }

    /// Makes sin^2 a1 + cos^2 a1 = 1 and S^2 + C^2 = nu^2 again, to first order in what they miss.
    fn restore_lengths(&mut self) {
        let [square, inverse_square] = self.units.square;
        for (first, square, gain) in [(0, 1 << 60, 1 << 29), (2, square, inverse_square)] {
            let [s, c] = [self.z[first] - OFFSET, self.z[first + 1] - OFFSET];
            let part = |z: i64| ((z >> 32) * (z >> 32), ((z >> 32) * (z & 0xffff_ffff)) >> 31);
            let ((s2, s_more), (c2, c_more)) = (part(s), part(c));
            let missing = square - s2 - c2 - s_more - c_more;
            if missing.unsigned_abs() >= LENGTH {
                self.lost = true;
                return;
            }
            let relative = ((missing >> 20) * gain) >> 29;
            for z in &mut self.z[first..first + 2] {
                *z += ((*z >> 32) * relative) >> 9;
            }
        }
    }

    /// Gives the momenta what the words of G1 and G2 have missed since the last time, times sin a1 and nu sin a2.
    fn make_up_for_gravity(&mut self) {
        let [sin1, cos1, s, c, ..] = self.quantities();
        for (i, sine) in [sin1, sin1 * c - cos1 * s].into_iter().enumerate() {
            self.z[4 + i] -= product(self.units.missed[i], sine.0) >> 28;
        }
    }

    /// The energy above rest, ((P1 - C P2)^2 r + P2^2)/2 + G1 (1 - cos a1) + G2 nu (1 - cos a2), with 60 bits after the
    /// point and as many fewer as the units of momenta and rates differ by.
    pub(super) fn energy(&self) -> i64 {
        let [sin1, cos1, s, c, p1, p2] = self.quantities();
        let (coefficients, shifts) = (&self.units.coefficients, self.units.scaling.shifts);
        let momentum = p1 - Paced::<false>(shifts).momentum(c * p2);
        let u = Paced::<false>(shifts).rate(momentum, self.inverse);
        let product = |a: i32, b: i32| i64::from(a) * i64::from(b);
        let [gravity1, gravity2] = coefficients.gravity.map(|gravity| gravity.0);
        // up to 2, which is too much for a word
        let heights = [
            (1 << 30) - i64::from(cos1.0),
            i64::from(coefficients.norm.0) - i64::from((c * cos1 + s * sin1).0),
        ];
        let (upper, lower) = (shifts.momentum + shifts.upper, shifts.lower);
        (product(momentum.0, u.0) >> (1 + shifts.upper + lower))
            + (product(p2.0, p2.0) >> (1 + upper + lower))
            + ((i64::from(gravity1) * heights[0]) >> (3 + lower))
            + ((i64::from(gravity2) * heights[1]) >> (3 + upper))
    }
}

impl Q30 {
    /// Itself, where it is nearly r = 1/(m + S^2), by a step of Newton's: the only number that is rounded to nearest.
    #[inline(always)]
    pub fn inverse_of(self, inertia: Self, s: Self, shifts: &Shifts) -> Self {
        let part = word((product(s.0, self.0) + (1 << 29)) >> 30);
        let square = (product(part, s.0) << shifts.inverse) >> shifts.momentum; // S^2 r beside m r
        let missing = (1 << 60) - product(inertia.0, self.0) - square;
        // what is missing is small: 32 bits after the point
        let change = product(self.0, word(missing >> 28));
        self + Self(((change + (1 << 31)) >> 32) as i32)
    }
}
