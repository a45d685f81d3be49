//! What is computed in: floating point, fixed point, many of either side by side, and the sines.

pub(crate) mod fixed;
mod lanes;
mod real;
mod scalar;
mod sine;

pub use lanes::Lanes;
pub use real::Real;
pub use scalar::{Scalar, Sealed};
