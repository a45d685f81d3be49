//! The step of classical RK4 in the direction form, for every kind of number that has one unit for all quantities; and for many
//! motions at once.
//!
//! Loops and functions rather than array methods and closures, which are not always inlined in code for a processor's vectors.

use super::{Plain, Sum};
use crate::methods::rk4_direction::Rk4Direction;
use crate::numbers::{Lanes, Real, Scalar};
use crate::pendulum::Direction;
use crate::pendulum::directions::{Coefficients, Rates, Same, increments, rod_directions};

/// A motion's z = (sin a1, cos a1, S, C, P1, P2), and r there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point<R> {
    pub z: [R; 6],
    pub inverse: R,
}

/// A step half made: where the next k is found, and the sum of those so far.
#[derive(Clone, Copy, Debug)]
struct Stage<R> {
    at: Point<R>,
    sum: [R; 6],
}

impl<R: Scalar<Gravity = R, Slope = R, Torque = R>> Stage<R> {
    /// After k1.
    #[inline(always)]
    fn first(coefficients: &Coefficients<R>, start: &Point<R>) -> Self {
        let k1 = increments(&start.z, start.rates(coefficients));
        Self {
            at: start.ahead(&k1, start),
            sum: k1,
        }
    }

    /// After k2.
    #[inline(always)]
    fn second(&mut self, coefficients: &Coefficients<R>, start: &Point<R>) {
        let k2 = increments(&self.at.z, self.at.rates(coefficients));
        self.sum = with(&self.sum, &k2, |sum, k2| sum + k2.twice());
        self.at = start.ahead(&k2, &self.at);
    }

    /// After k3.
    #[inline(always)]
    fn third(&mut self, coefficients: &Coefficients<R>, start: &Point<R>) {
        let Rates { angles, momenta } = self.at.rates(coefficients);
        let doubled = Rates {
            angles: angles.map(R::twice),
            momenta: momenta.map(R::twice),
        };
        let twice_k3 = increments(&self.at.z, doubled);
        self.sum = with(&self.sum, &twice_k3, R::add);
        self.at = start.ahead(&twice_k3, &self.at);
    }

    /// Puts `start` where the step ends, a third of k1 + 2 k2 + 2 k3 + k4 further.
    ///
    /// r = 1/(m + S^2) there by one Newton step from that of k4, which is off by the third power of the step. A step that changes r
    /// by a third or more makes no sense with it, nor with RK4.
    #[inline(always)]
    fn last(
        &self,
        coefficients: &Coefficients<R>,
        start: &mut Point<R>,
        sums: &mut [impl Sum<R>; 6],
    ) {
        let k4 = increments(&self.at.z, self.at.rates(coefficients));
        let (sum, last) = (with(&self.sum, &k4, R::add), self.at.inverse);
        for i in 0..6 {
            start.z[i] = sums[i].add(start.z[i], sum[i] * R::from_f64(1.0 / 3.0));
        }
        let s = start.z[2];
        start.inverse =
            last + last * ((R::from_f64(1.0) - coefficients.inertia * last) - (s * last) * s);
    }
}

impl<R: Scalar<Gravity = R, Slope = R, Torque = R>> Point<R> {
    #[inline(always)]
    pub fn step(&mut self, coefficients: &Coefficients<R>, sums: &mut [impl Sum<R>; 6]) {
        let mut stage = Stage::first(coefficients, self);
        stage.second(coefficients, self);
        stage.third(coefficients, self);
        stage.last(coefficients, self, sums);
    }

    #[inline(always)]
    fn rates(&self, coefficients: &Coefficients<R>) -> Rates<R> {
        coefficients.rates(&Same, &self.z, self.inverse)
    }

    /// The point `k` further, where `k` was found at `from`: the inverse falls by 2 S S' r^2.
    #[inline(always)]
    fn ahead(&self, k: &[R; 6], from: &Self) -> Self {
        let z = with(&self.z, k, R::add);
        let fall = k[2].twice() * (from.z[2] * from.inverse) * from.inverse;
        Self {
            z,
            inverse: self.inverse - fall,
        }
    }

    /// Makes sin^2 a1 + cos^2 a1 = 1 and S^2 + C^2 = nu^2 again, to first order in what they miss; nu is `norm`.
    #[inline(always)]
    pub fn restore_lengths(
        &mut self,
        norm: R,
        half_inverse_square: R,
        sums: &mut [impl Sum<R>; 6],
    ) {
        for (i, length, gain) in [
            (0, R::from_f64(1.0), R::from_f64(0.5)),
            (2, norm, half_inverse_square),
        ] {
            let [s, c] = [self.z[i], self.z[i + 1]];
            let lost = s * sums[i].lost() + c * sums[i + 1].lost();
            let missing = gain * (((length - c) * (length + c) - s * s) - (lost + lost));
            self.z[i] = sums[i].add(s, s * missing);
            self.z[i + 1] = sums[i + 1].add(c, c * missing);
        }
    }
}

#[inline(always)]
fn with<R: Copy>(one: &[R; 6], other: &[R; 6], operation: impl Fn(R, R) -> R) -> [R; 6] {
    let mut all = *one;
    for (one, other) in all.iter_mut().zip(other) {
        *one = operation(*one, *other);
    }
    all
}

/// As [`DirectionForm`] in plain numbers, bit-identical, for `ROWS` times `N` motions of one pendulum side by side.
///
/// Every row makes a stage before any makes the next: a stage waits for the one before it, and meanwhile the processor
/// computes the other rows. Who steps restores the lengths and leaves out steps, when each motion would alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectionLanes<R, const N: usize, const ROWS: usize> {
    coefficients: Coefficients<Lanes<R, N>>,
    half_inverse_square: Lanes<R, N>,
    rows: [Row<Lanes<R, N>>; ROWS],
}

/// Motions at the start of a step, and within it.
type Row<R> = (Point<R>, Stage<R>);

impl<const N: usize, const ROWS: usize> DirectionLanes<f32, N, ROWS> {
    /// All of them as `motion`.
    #[inline(always)]
    pub fn new(motion: &Rk4Direction<false>) -> Self {
        let (coefficients, half_inverse_square, z, inverse) = motion.parts();
        let coefficients = coefficients.splat();
        let start = Point {
            z: z.map(Lanes::splat),
            inverse: Lanes::splat(inverse),
        };
        let rows = [(start, Stage::first(&coefficients, &start)); ROWS];
        Self {
            coefficients,
            half_inverse_square: Lanes::splat(half_inverse_square),
            rows,
        }
    }

    /// Puts another motion into a lane.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, motion: &Rk4Direction<false>) {
        let (_, _, z, inverse) = motion.parts();
        self.lane(lane)
            .zip(z.into_iter().chain([inverse]))
            .for_each(|(place, number)| *place = number);
    }
}

impl<R: Real, const N: usize, const ROWS: usize> DirectionLanes<R, N, ROWS> {
    /// The numbers of a motion by its lane, counted through all rows; none of one that there is not.
    #[inline(always)]
    fn lane(&mut self, lane: usize) -> impl Iterator<Item = &mut R> {
        let row = self
            .rows
            .get_mut(lane / N)
            .map(|(start, _)| start.z.iter_mut().chain([&mut start.inverse]));
        row.into_iter()
            .flatten()
            .map(move |number| &mut number.0[lane % N])
    }

    /// Takes a lane back to what it was in `before`.
    #[inline(always)]
    pub fn keep(&mut self, lane: usize, before: &mut Self) {
        self.lane(lane)
            .zip(before.lane(lane))
            .for_each(|(place, number)| *place = *number);
    }

    #[inline(always)]
    pub fn step(&mut self) {
        let Self {
            coefficients, rows, ..
        } = self;
        for (start, stage) in &mut *rows {
            *stage = Stage::first(coefficients, start);
        }
        for (start, stage) in &mut *rows {
            stage.second(coefficients, start);
        }
        for (start, stage) in &mut *rows {
            stage.third(coefficients, start);
        }
        for (start, stage) in &mut *rows {
            stage.last(coefficients, start, &mut [Plain; 6]);
        }
    }

    #[inline(always)]
    pub fn restore_lengths(&mut self) {
        for (start, _) in &mut self.rows {
            start.restore_lengths(
                self.coefficients.norm,
                self.half_inverse_square,
                &mut [Plain; 6],
            );
        }
    }

    /// As of [`Form::rod_directions`](crate::methods::Form::rod_directions), of a row.
    #[inline(always)]
    pub fn rod_directions(&self, row: usize) -> [Direction<Lanes<R, N>>; 2] {
        rod_directions(&self.rows[row].0.z)
    }
}
