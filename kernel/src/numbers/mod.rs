//! The numbers that the methods compute in, and the sines.

pub(crate) mod fixed;
mod lanes;
mod real;
mod sine;

pub(crate) use lanes::Lanes;
pub use real::{Real, RealOperations, sin_cos};
pub use sine::radians;
