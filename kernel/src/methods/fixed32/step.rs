//! A step of RK4 in words of 32 bits.

use super::Fixed32;
use super::setting::Setting;
use crate::methods::scaling::Shifts;
use crate::numbers::Scalar;
use crate::numbers::fixed::{IN_HALVES, Q30, Slope, Torque, product, word};
use crate::pendulum::directions::{Rates, Reverse, turning};

/// Whether to compile the step once for every usual length, with shifts that cost nothing. A chip with a floating-point unit
/// has a faster form and better use for its flash.
const SPECIALISED: bool = !cfg!(target_abi = "eabihf");

/// The word times 2^`by`, `by` being from 1 to 31.
#[inline(always)]
fn shifted(word: i32, by: u32) -> i64 {
    i64::from(word >> (32 - by)) << 32 | i64::from((word as u32) << by)
}

impl Fixed32 {
    /// Makes `steps` steps without upkeep.
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
        let Setting { coefficients, reverse, .. } = &self.units;
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
        let half_fall =
            |s_rate: Slope, s: Q30, r: Q30| (s_rate.number() * (s * r)).up(half_up).down(units.momentum).slope(r);
        let fallen = |k: Slope| Q30((k + k + k).0 >> (halvings - 3)).up(units.inverse - half_up);

        // All is rounded down. Every second slope is taken backwards in time, with reversed momenta, so that as much is
        // rounded up.
        let (turns1, torques1) = slopes(&z, coefficients.rates(&units, &z, inverse));
        let [sin1, cos1, s, c, p1, p2] = moved(turns1, torques1, halvings);
        let z2 = [z[0] + sin1, z[1] + cos1, z[2] + s, z[3] + c, -z[4] - p1, -z[5] - p2];
        let fall1 = half_fall(turns1[2], z[2], inverse);
        let r2 = inverse - fallen(fall1);

        let (turns2, torques2) = slopes(&z2, reverse.rates(&Reverse(units), &z2, r2));
        let change = moved(turns2, torques2, halvings);
        let z3: [Q30; 6] = core::array::from_fn(|i| z[i] - change[i]);
        let fall2 = half_fall(turns2[2], z2[2], r2);
        let r3 = inverse + fallen(fall2);

        let (turns3, torques3) = slopes(&z3, coefficients.rates(&units, &z3, r3));
        let middle: [Slope; 4] = core::array::from_fn(|i| turns3[i] - turns2[i]);
        let middle_torques: [Torque; 2] = core::array::from_fn(|i| torques3[i] - torques2[i]);
        let [sin1, cos1, s, c, p1, p2] = moved(turns3, torques3, halvings - 1);
        let z4 = [z[0] + sin1, z[1] + cos1, z[2] + s, z[3] + c, -z[4] - p1, -z[5] - p2];
        let fall3 = half_fall(turns3[2], z3[2], r3);
        let r4 = inverse - fallen(fall3).twice();

        let (turns4, torques4) = slopes(&z4, reverse.rates(&Reverse(units), &z4, r4));
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
