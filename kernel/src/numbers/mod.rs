//! The numbers that the methods compute in: floating point, fixed point, many numbers at once, and
//! the sines.

pub(crate) mod fixed;
mod lanes;
mod real;
mod sine;

pub(crate) use lanes::Lanes;
pub use real::Real;

/// Keeps a public trait to the types of this crate, so that it may get new methods.
pub trait Sealed {}
