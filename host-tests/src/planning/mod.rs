//! The planner held against the reference, and shown.

mod draw;
mod judge;
mod study;
mod target;

pub use draw::scenes;
pub use judge::{Verdict, judge};
pub use study::{Case, Class, GROSS, PLANNING, median, study};
pub use target::{CHIPS, Chip, M3, M4F};
