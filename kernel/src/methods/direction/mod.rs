//! The direction form in floating point: RK4 and extrapolation, of one motion or of many side by side.

mod classical;
mod coefficients;
mod extrapolated;
mod form;
mod lanes;
mod lead;
mod sum;

pub use extrapolated::ExtrapolationF64;
pub use form::DirectionForm;
pub(crate) use lanes::DirectionLanes;
pub(crate) use lead::BLOCK;
pub use sum::{Compensated, Plain, Sum};
