//! What is computed in: floating point, fixed point, many of either side by side, and the sines.

pub(crate) mod fixed;
mod real;
mod scalar;
mod sine;

pub use real::Real;
pub use scalar::{Lanes, Scalar, Sealed};
