//! What is done every few steps: lengths are restored, gravity's last digits are made up for, the energy is looked at.

use super::setting::Setting;
use super::{Fixed32, OFFSET, UPKEEP};
use crate::numbers::fixed::{Q30, product};
use crate::pendulum::directions::Units;

/// By how much the square of a length may be off, with 60 bits after the point.
const LENGTH: u64 = 1 << 51;

impl Fixed32 {
    #[inline(never)]
    pub(super) fn keep_up(&mut self) {
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

    /// Gives the momenta what the words of G1 and G2 have missed since the last time, and what the words of the torques have
    /// where these have stayed the same: of a pendulum let go from rest, half a step of them for a hundred steps is seen later.
    fn make_up_for_gravity(&mut self) {
        let Setting { missed, halvings, .. } = self.units;
        let (directions, weights) = (self.sines(), self.weights_now());
        for i in 0..2 {
            let (before, now) = (self.weights[i], weights[i]);
            let mut made_up = product(missed[i], directions[i].0) >> 28;
            if before >> 32 == now >> 32 {
                // of every second slope it is rounded up, so half a step is in it, but where it is a whole number
                let dropped = |weight: i64| if weight as u32 == 0 { 0 } else { i64::from(weight as u32) - (1 << 31) };
                made_up += ((dropped(before) + dropped(now)) * (3 * i64::from(UPKEEP) / 2)) >> halvings;
            }
            self.z[4 + i] -= made_up;
        }
        self.weights = weights;
    }

    /// sin a1 and nu sin a2.
    fn sines(&self) -> [Q30; 2] {
        let [sin1, cos1, s, c, ..] = self.quantities();
        [sin1, sin1 * c - cos1 * s]
    }

    /// The torques of gravity, with 63 bits after the point.
    pub(super) fn weights_now(&self) -> [i64; 2] {
        let (gravity, sines) = (self.units.coefficients.gravity, self.sines());
        [0, 1].map(|i| product(gravity[i].0, sines[i].0))
    }

    /// The energy above rest, ((P1 - C P2)^2 r + P2^2)/2 + G1 (1 - cos a1) + G2 nu (1 - cos a2), with 60 bits after the
    /// point and as many fewer as the units of momenta and rates differ by.
    pub(super) fn energy(&self) -> i64 {
        let [sin1, cos1, s, c, p1, p2] = self.quantities();
        let (coefficients, shifts) = (&self.units.coefficients, &self.units.scaling.shifts);
        let momentum = p1 - shifts.momentum(c * p2);
        let u = shifts.rate(momentum, self.inverse);
        let product = |a: i32, b: i32| i64::from(a) * i64::from(b);
        let [gravity1, gravity2] = coefficients.gravity.map(|gravity| gravity.0);
        // up to 2, which is too much for a word
        let heights =
            [(1 << 30) - i64::from(cos1.0), i64::from(coefficients.norm.0) - i64::from((c * cos1 + s * sin1).0)];
        let (upper, lower) = (shifts.momentum + shifts.upper, shifts.lower);
        (product(momentum.0, u.0) >> (1 + shifts.upper + lower))
            + (product(p2.0, p2.0) >> (1 + upper + lower))
            + ((i64::from(gravity1) * heights[0]) >> (3 + lower))
            + ((i64::from(gravity2) * heights[1]) >> (3 + upper))
    }
}
