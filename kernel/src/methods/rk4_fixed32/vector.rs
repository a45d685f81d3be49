//! The six quantities of the direction form, and their sums.

use core::ops::{Add, Sub};

use crate::numbers::fixed::{Q30, Slope, Torque};

/// One number for each of the six quantities: `D` for those of directions, `M` for momenta.
#[derive(Clone, Copy)]
pub struct Quantities<D, M> {
    pub sin1: D,
    pub cos1: D,
    pub s: D,
    pub c: D,
    pub p1: M,
    pub p2: M,
}

pub type Words = Quantities<Q30, Q30>;

pub type Rates = Quantities<Slope, Torque>;

impl Words {
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
