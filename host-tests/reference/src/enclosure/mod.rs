//! The exact motion, enclosed: a set that it is proved to be in, frame by frame.
//!
//! Nothing here is estimated. Every bound names its theorem where it stands; what is rounded is counted.

mod discs;
mod equations;
mod fixed;
mod set;
mod start;

pub use equations::Constants;
pub use fixed::Fixed;
pub use set::{Enclosure, Fineness};
pub use start::{Start, sin_cos};
