//! The six quantities of the direction form, and their sums.

use core::ops::{Add, Sub};

use crate::numbers::fixed::{Q30, Slope, Torque};

/// One number for each of the six quantities sin a1, cos a1, S, C, P1 and P2: `D` for those of
/// directions, `M` for momenta. None has a dimension. All are in the units of the motion
/// ([`Scaling`](crate::methods::scaling::Scaling)), which also divide nu by a power of two. Each
/// number is added alone. A sum that does not fit its format panics in unit tests and wraps in
/// other builds.
#[derive(Clone, Copy)]
pub struct Quantities<D, M> {
    /// sin a1.
    pub sin1: D,
    /// cos a1.
    pub cos1: D,
    /// S = nu sin (a1 - a2), with the divided nu.
    pub s: D,
    /// C = nu cos (a1 - a2), with the divided nu.
    pub c: D,
    /// P1.
    pub p1: M,
    /// P2.
    pub p2: M,
}

/// The quantities themselves, in words of 32 bits. The state is rounded to the nearest words.
pub type Words = Quantities<Q30, Q30>;

/// The rates of change of the quantities, per unit of time T.
pub type Rates = Quantities<Slope, Torque>;

impl Words {
    /// Returns the same point with reversed momenta.
    pub fn reversed(self) -> Self {
        Self {
            p1: -self.p1,
            p2: -self.p2,
            ..self
        }
    }
}

impl<D: Add<Output = D>, M: Add<Output = M>> Add for Quantities<D, M> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            sin1: self.sin1 + other.sin1,
            cos1: self.cos1 + other.cos1,
            s: self.s + other.s,
            c: self.c + other.c,
            p1: self.p1 + other.p1,
            p2: self.p2 + other.p2,
        }
    }
}

impl<D: Sub<Output = D>, M: Sub<Output = M>> Sub for Quantities<D, M> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self {
            sin1: self.sin1 - other.sin1,
            cos1: self.cos1 - other.cos1,
            s: self.s - other.s,
            c: self.c - other.c,
            p1: self.p1 - other.p1,
            p2: self.p2 - other.p2,
        }
    }
}
