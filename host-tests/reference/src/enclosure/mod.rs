//! The exact motion, enclosed: a set that it is proved to be in, frame by frame.
//!
//! Nothing here is estimated. Every bound names its theorem where it stands; what is rounded is counted.

mod ball;
mod discs;
mod enclosure;
mod equations;
mod fixed;
mod number;
mod start;
mod tangents;
mod verdict;

pub use ball::Ball;
pub use enclosure::{Enclosure, Fineness, Lost};
pub use equations::Constants;
pub use fixed::Fixed;
pub use number::Number;
pub use start::{Given, Start, sin_cos};
pub use verdict::Verdict;
