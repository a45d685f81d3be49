//! Many numbers at once, in the processor's vectors.

use core::array::from_fn;
use core::ops::{Add, Mul, Neg, Sub};

/// `N` numbers, one in each *lane*. Every operation acts on each lane alone, with the same bits as
/// on one number.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(32))]
pub(crate) struct Lanes<R, const N: usize>(pub [R; N]);

impl<R: Copy, const N: usize> Lanes<R, N> {
    pub fn splat(number: R) -> Self {
        Self([number; N])
    }
}

impl<R: Copy + Add<Output = R>, const N: usize> Lanes<R, N> {
    pub fn twice(self) -> Self {
        self + self
    }
}

impl<R: Copy + Add<Output = R>, const N: usize> Add for Lanes<R, N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(from_fn(|lane| self.0[lane] + other.0[lane]))
    }
}

impl<R: Copy + Sub<Output = R>, const N: usize> Sub for Lanes<R, N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(from_fn(|lane| self.0[lane] - other.0[lane]))
    }
}

impl<R: Copy + Mul<Output = R>, const N: usize> Mul for Lanes<R, N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self(from_fn(|lane| self.0[lane] * other.0[lane]))
    }
}

impl<R: Copy + Neg<Output = R>, const N: usize> Neg for Lanes<R, N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.map(R::neg))
    }
}
