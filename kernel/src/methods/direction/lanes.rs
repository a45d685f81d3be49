//! The plain direction form for many motions at once.

use super::DirectionForm;
use super::Plain;
use super::classical::{Point, Stage, missing, newton_inverse};
use super::coefficients::third;
use crate::numbers::{Lanes, Real, Scalar};
use crate::pendulum::Direction;
use crate::pendulum::directions::{Coefficients, heads};

/// As [`DirectionForm`] in plain numbers, to the bit, for `ROWS` times `N` motions of one pendulum side by side.
///
/// Every row makes a stage before any makes the next: a stage waits for the one before it, and meanwhile the processor
/// computes the other rows. Who steps restores the lengths and leaves out steps, when each
/// motion would alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectionLanes<R, const N: usize, const ROWS: usize> {
    coefficients: Coefficients<Lanes<R, N>>,
    half_inverse_square: R,
    rows: [Row<Lanes<R, N>>; ROWS],
}

/// Motions at the start of a step, and within it.
#[derive(Clone, Copy, Debug)]
struct Row<R> {
    start: Point<R>,
    stage: Stage<R>,
}

impl<R: Real, const N: usize, const ROWS: usize> DirectionLanes<R, N, ROWS> {
    /// All of them as `motion`.
    #[inline(always)]
    pub fn new(motion: &DirectionForm<R, Plain>) -> Self {
        let coefficients = motion.coefficients.splat();
        let start = Point { z: motion.z.map(Lanes::splat), inverse: Lanes::splat(motion.inverse) };
        let stage = Stage::first(&coefficients, &start);
        Self { coefficients, half_inverse_square: motion.half_inverse_square, rows: [Row { start, stage }; ROWS] }
    }

    /// Puts another motion into a lane, counted through all rows; one that there is not is left alone.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, motion: &DirectionForm<R, Plain>) {
        let Some(Row { start, .. }) = self.rows.get_mut(lane / N) else { return };
        let places = start.z.iter_mut().chain([&mut start.inverse]);
        for (place, number) in places.zip(motion.z.into_iter().chain([motion.inverse])) {
            place.0[lane % N] = number;
        }
    }

    /// Takes a lane back to what it was in `before`.
    #[inline(always)]
    pub fn keep(&mut self, lane: usize, before: &Self) {
        let (Some(row), Some(kept)) = (self.rows.get_mut(lane / N), before.rows.get(lane / N)) else { return };
        let places = row.start.z.iter_mut().chain([&mut row.start.inverse]);
        for (place, number) in places.zip(kept.start.z.iter().chain([&kept.start.inverse])) {
            place.0[lane % N] = number.0[lane % N];
        }
    }

    #[inline(always)]
    pub fn step(&mut self) {
        let Self { coefficients, rows, .. } = self;
        for Row { start, stage } in &mut *rows {
            *stage = Stage::first(coefficients, start);
        }
        for Row { start, stage } in &mut *rows {
            stage.second(coefficients, start);
        }
        for Row { start, stage } in &mut *rows {
            stage.third(coefficients, start);
        }
        for Row { start: Point { z, inverse }, stage } in &mut *rows {
            let (sum, last) = stage.last(coefficients);
            for (z, sum) in z.iter_mut().zip(sum) {
                *z = *z + sum * Lanes::splat(third());
            }
            *inverse = newton_inverse(last, coefficients.inertia, z[2]);
        }
    }

    #[inline(always)]
    pub fn restore_lengths(&mut self) {
        let ways = [(0, Lanes::splat(R::ONE), R::HALF), (2, self.coefficients.norm, self.half_inverse_square)];
        for Row { start: Point { z, .. }, .. } in &mut self.rows {
            for (i, length, gain) in ways {
                let [s, c] = [z[i], z[i + 1]];
                let missing = missing([s, c], Lanes::from_f64(0.0), length, Lanes::splat(gain));
                z[i] = s + s * missing;
                z[i + 1] = c + c * missing;
            }
        }
    }

    /// As of [`Form::heads`](crate::methods::Form::heads), of a row.
    #[inline(always)]
    pub fn heads(&self, row: usize) -> [Direction<Lanes<R, N>>; 2] {
        heads(&self.rows[row].start.z)
    }
}
