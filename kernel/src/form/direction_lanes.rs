//! The plain direction form for many motions at once.

use core::array::from_fn;

use super::Direction;
use super::classical;
use super::coefficients::third;
use super::direction::{DirectionForm, DirectionState};
use super::equations::Coefficients;
use super::heads::heads;
use super::inverse::{Followed, Inverse};
use super::sum::Plain;
use crate::lanes::Lanes;
use crate::real::Real;
use crate::ring::Ring;

/// As [`DirectionForm`] in plain numbers, to the bit, for `N` motions of one pendulum side by side.
///
/// Who steps restores the lengths, and when: each motion wants it as often as it would alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DirectionLanes<R, const N: usize> {
    coefficients: Coefficients<Lanes<R, N>>,
    half_inverse_square: R,
    /// sin a1, cos a1, S, C, P1, P2.
    z: [Lanes<R, N>; 6],
    inverse: Lanes<R, N>,
}

impl<R: Real, const N: usize> DirectionLanes<R, N> {
    /// Motions of `form`, all of them as `resting`.
    #[inline(always)]
    pub fn new(form: &DirectionForm<R, Plain>, resting: &DirectionState<R, Plain>) -> Self {
        let Coefficients { norm, inertia, gravity } = form.coefficients;
        let coefficients = Coefficients {
            norm: Lanes::splat(norm),
            inertia: Lanes::splat(inertia),
            gravity: gravity.map(Lanes::splat),
        };
        let (z, inverse) = (resting.z.map(Lanes::splat), Lanes::splat(resting.inverse));
        Self { coefficients, half_inverse_square: form.half_inverse_square, z, inverse }
    }

    /// Puts another motion into a lane; one that there is not is left alone.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, motion: &DirectionState<R, Plain>) {
        let places = self.z.iter_mut().chain([&mut self.inverse]);
        for (place, number) in places.zip(motion.z.into_iter().chain([motion.inverse])) {
            if let Some(place) = place.0.get_mut(lane) {
                *place = number;
            }
        }
    }

    /// Makes a step of each.
    #[inline(always)]
    pub fn step(&mut self) {
        let (sum, last) = classical::stages::<_, Followed>(&self.coefficients, &self.z, self.inverse);
        let third = Lanes::splat(third());
        self.z = from_fn(|i| self.z[i] + sum[i] * third);
        self.inverse = <Followed as Inverse<Lanes<R, N>>>::at_end(last, self.coefficients.inertia, self.z[2]);
    }

    /// Restores the lengths of each.
    #[inline(always)]
    pub fn restore_lengths(&mut self) {
        let ways = [(0, Lanes::splat(R::ONE), R::HALF), (2, self.coefficients.norm, self.half_inverse_square)];
        for (i, length, gain) in ways {
            let [s, c] = [self.z[i], self.z[i + 1]];
            let missing = classical::missing([s, c], Lanes::constant(0.0), length, Lanes::splat(gain));
            self.z[i] = s + s * missing;
            self.z[i + 1] = c + c * missing;
        }
    }

    /// As of [`Watched`](super::heads::Watched).
    #[inline(always)]
    pub fn heads(&self) -> [Direction<Lanes<R, N>>; 2] {
        heads(&self.z)
    }
}
