//! The corrections after every 32 steps of [`Fixed32`]: lengths, rounded constants, and the check
//! of the energy.

use super::{Fixed32, OFFSET};
use crate::numbers::fixed::product;

pub(super) const RENORMALISE_EVERY: u32 = 32;

/// With 60 fractional bits.
const LENGTH_ERROR: u64 = 1 << 51;

impl Fixed32 {
    #[inline(never)] // Maps of flips take 57 instead of 53 % of a frame on an M0+ without.
    pub(super) fn renormalise(&mut self) {
        self.restore_lengths();
        self.add_missed_gravity();
        self.lost |= self.energy() > self.units.most_energy;
    }

    /// Restores the lengths to first order in the error.
    fn restore_lengths(&mut self) {
        let units = &self.units;
        let directions = [
            (0, 1 << 60, 1 << 29),
            (2, units.square, units.inverse_square),
        ];
        for (first, square, gain) in directions {
            // The squares of both components with 60 fractional bits. The second number of a pair
            // is twice the product of upper and lower word, which the first leaves out.
            let [s, c] = [self.z[first] - OFFSET, self.z[first + 1] - OFFSET];
            let part = |z: i64| ((z >> 32) * (z >> 32), ((z >> 32) * (z & 0xffff_ffff)) >> 31);
            let ((s2, s_more), (c2, c_more)) = (part(s), part(c));
            let missing = square - s2 - c2 - s_more - c_more;

            if missing.unsigned_abs() >= LENGTH_ERROR {
                self.lost = true;
                return;
            }

            let relative = ((missing >> 20) * gain) >> 29;
            for z in &mut self.z[first..first + 2] {
                *z += ((*z >> 32) * relative) >> 9;
            }
        }
    }

    /// Adds the torque of the last 32 steps that the rounding of G1 and G2 left out.
    fn add_missed_gravity(&mut self) {
        let z = self.words();
        let [missed1, missed2] = self.units.missed;
        let nu_sin2 = z.sin1 * z.c - z.cos1 * z.s;
        self.z[4] -= product(missed1, z.sin1.0) >> 28;
        self.z[5] -= product(missed2, nu_sin2.0) >> 28;
    }

    /// Returns the energy above rest, ((P1 - C P2)^2 r + P2^2)/2 + G1 (1 - cos a1) + G2 nu (1 - cos
    /// a2).
    ///
    /// It has 60 fractional bits: its unit is 2^(momentum + upper - lower - 60) m2 l2^2/T^2, J,
    /// with the [`Shifts`](crate::methods::scaling::Shifts) of the motion.
    pub(super) fn energy(&self) -> i64 {
        let z = self.words();
        let shifts = self.units.scaling.shifts;
        let product = |a: i32, b: i32| i64::from(a) * i64::from(b);

        let momentum = z.p1 - (z.c * z.p2).down(shifts.momentum);
        let u = momentum.product_up(self.inverse, shifts.inverse);

        // The heights 1 - cos a1 and nu (1 - cos a2) can be 2, which does not fit a word.
        let [gravity1, gravity2] = self.units.gravity.map(|gravity| i64::from(gravity.0));
        let nu_cos2 = z.c * z.cos1 + z.s * z.sin1;
        let height1 = (1 << 30) - i64::from(z.cos1.0);
        let height2 = i64::from(self.units.norm.0) - i64::from(nu_cos2.0);

        let upper = shifts.momentum + shifts.upper;
        let lower = shifts.lower;
        (product(momentum.0, u.0) >> (1 + shifts.upper + lower))
            + (product(z.p2.0, z.p2.0) >> (1 + upper + lower))
            + ((gravity1 * height1) >> (3 + lower))
            + ((gravity2 * height2) >> (3 + upper))
    }
}
