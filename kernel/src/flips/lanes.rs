//! RK4 in the direction form for many motions of one pendulum at once, in the processor's vectors.
//!
//! The result of each lane is bit-identical to that of
//! [`Rk4Direction`](crate::methods::Rk4Direction) in plain `f32`, whose page explains the equations
//! and the step.
//!
//! A function that is not inlined is not compiled for the vectors of the caller's processor. Each
//! `inline(always)` of this folder is therefore needed: with AVX2 a map takes 1.4 times as long if
//! `step` is not inlined, 1.6 times if the stages are not, and 1.8 times if `ahead`, `changes` and
//! `rates` are not. For the same reason the code uses loops instead of array methods. The crate
//! `wide` chooses its instructions when it is compiled itself: with AVX2 a map took 1.8 times as
//! long.

use crate::methods::DirectionF32Plain;
use crate::methods::direction::{Coefficients, changes, missing, rates};
use crate::numbers::Lanes;

pub(super) type Numbers<const N: usize> = Lanes<f32, N>;

/// The six quantities sin a1, cos a1, S, C, P1 and P2 of `N` motions, and r = 1/(m + S^2).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point<const N: usize> {
    z: [Numbers<N>; 6],
    inverse: Numbers<N>,
}

type Constants<const N: usize> = Coefficients<Numbers<N>>;

/// A step in progress: the point of the next stage, and the weighted sum of the earlier stages.
#[derive(Clone, Copy, Debug)]
struct Stage<const N: usize> {
    at: Point<N>,
    sum: [Numbers<N>; 6],
}

/// `ROWS` times `N` motions of one pendulum.
///
/// Each stage is computed for all rows before the next stage of any row. A stage must wait for the
/// one before it, and meanwhile the processor computes the other rows.
///
/// The caller restores the lengths after every block of steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct DirectionLanes<const N: usize, const ROWS: usize> {
    constants: Constants<N>,
    rows: [(Point<N>, Stage<N>); ROWS],
}

impl<const N: usize, const ROWS: usize> DirectionLanes<N, ROWS> {
    pub fn new(motion: &DirectionF32Plain) -> Self {
        let (coefficients, z, inverse) = motion.parts();
        let constants = Constants {
            norm: Lanes::splat(coefficients.norm),
            inertia: Lanes::splat(coefficients.inertia),
            gravity: coefficients.gravity.map(Lanes::splat),
            half_inverse_square: Lanes::splat(coefficients.half_inverse_square),
        };
        let start = Point {
            z: z.map(Lanes::splat),
            inverse: Lanes::splat(inverse),
        };
        let rows = [(start, constants.first_stage(&start)); ROWS];
        Self { constants, rows }
    }

    /// Puts another motion of the same pendulum and step into a lane. The lengths of all lanes are
    /// restored at once, so that it must begin when a block does.
    pub fn put(&mut self, lane: usize, motion: &DirectionF32Plain) {
        let (_, z, inverse) = motion.parts();
        let numbers = z.into_iter().chain([inverse]);
        for (place, number) in self.lane(lane).zip(numbers) {
            *place = number;
        }
    }

    /// Resets a lane to its motion in `before`, to leave out the last step of a block, as a single
    /// motion would.
    pub fn keep(&mut self, lane: usize, before: &mut Self) {
        for (place, number) in self.lane(lane).zip(before.lane(lane)) {
            *place = *number;
        }
    }

    #[inline(always)]
    pub fn step(&mut self) {
        let constants = &self.constants;
        for (start, stage) in &mut self.rows {
            *stage = constants.first_stage(start);
        }
        for (start, stage) in &mut self.rows {
            constants.second_stage(start, stage);
        }
        for (start, stage) in &mut self.rows {
            constants.third_stage(start, stage);
        }
        for (start, stage) in &mut self.rows {
            constants.last_stage(start, stage);
        }
    }

    pub fn restore_lengths(&mut self) {
        for (start, _) in &mut self.rows {
            self.constants.restore_lengths(start);
        }
    }

    /// Returns (sin, cos) of both rods in the lanes of a row; (S, C) for rod 2.
    pub fn rods(&self, row: usize) -> [[Numbers<N>; 2]; 2] {
        let [sin1, cos1, s, c, ..] = self.rows[row].0.z;
        [[sin1, cos1], [sin1 * c - cos1 * s, cos1 * c + sin1 * s]]
    }

    fn lane(&mut self, lane: usize) -> impl Iterator<Item = &mut f32> {
        let row = self
            .rows
            .get_mut(lane / N)
            .map(|(start, _)| start.z.iter_mut().chain([&mut start.inverse]));
        row.into_iter()
            .flatten()
            .map(move |number| &mut number.0[lane % N])
    }
}

impl<const N: usize> Constants<N> {
    #[inline(always)]
    fn first_stage(&self, start: &Point<N>) -> Stage<N> {
        let k1 = changes(&start.z, self.rates(start));
        Stage {
            at: start.ahead(&k1, start),
            sum: k1,
        }
    }

    #[inline(always)]
    fn second_stage(&self, start: &Point<N>, stage: &mut Stage<N>) {
        let k2 = changes(&stage.at.z, self.rates(&stage.at));
        for (sum, k2) in stage.sum.iter_mut().zip(&k2) {
            *sum = *sum + k2.twice();
        }
        stage.at = start.ahead(&k2, &stage.at);
    }

    #[inline(always)]
    fn third_stage(&self, start: &Point<N>, stage: &mut Stage<N>) {
        let [u, v, p1, p2] = self.rates(&stage.at);
        let twice_rates = [u.twice(), v.twice(), p1.twice(), p2.twice()];
        let twice_k3 = changes(&stage.at.z, twice_rates);
        for (sum, twice_k3) in stage.sum.iter_mut().zip(&twice_k3) {
            *sum = *sum + *twice_k3;
        }
        stage.at = start.ahead(&twice_k3, &stage.at);
    }

    #[inline(always)]
    fn last_stage(&self, start: &mut Point<N>, stage: &Stage<N>) {
        let k4 = changes(&stage.at.z, self.rates(&stage.at));
        let third = Lanes::splat(1.0 / 3.0);
        for ((z, sum), k4) in start.z.iter_mut().zip(&stage.sum).zip(&k4) {
            *z = *z + (*sum + *k4) * third;
        }

        // One step of Newton's method from its value in the last stage.
        let one = Lanes::splat(1.0);
        let s = start.z[2];
        let r4 = stage.at.inverse;
        start.inverse = r4 + r4 * ((one - self.inertia * r4) - (s * r4) * s);
    }

    #[inline(always)]
    fn rates(&self, at: &Point<N>) -> [Numbers<N>; 4] {
        rates(self.gravity, Lanes::splat(1.0), &at.z, at.inverse)
    }

    fn restore_lengths(&self, point: &mut Point<N>) {
        let one = Lanes::splat(1.0);
        let half = Lanes::splat(0.5);
        for (i, length, gain) in [(0, one, half), (2, self.norm, self.half_inverse_square)] {
            let [s, c] = [point.z[i], point.z[i + 1]];
            let missing = missing([s, c], length, gain, Lanes::splat(0.0));
            point.z[i] = s + s * missing;
            point.z[i + 1] = c + c * missing;
        }
    }
}

impl<const N: usize> Point<N> {
    #[inline(always)]
    fn ahead(&self, k: &[Numbers<N>; 6], from: &Self) -> Self {
        let mut z = self.z;
        for i in 0..6 {
            z[i] = z[i] + k[i];
        }
        let fall = k[2].twice() * (from.z[2] * from.inverse) * from.inverse;
        Self {
            z,
            inverse: self.inverse - fall,
        }
    }
}
