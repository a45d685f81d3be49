//! The planner held against the reference, and shown.

mod draw;
mod judge;
mod options;
mod study;
mod tables;
mod target;
mod words;

pub use draw::scenes;
pub use judge::{Verdict, judge};
pub use options::Options;
pub use study::{Case, Class, DURATIONS, GROSS, PLANNING, median, study};
pub use tables::{broken, classes};
pub use target::{CHIPS, Chip, M3, M4F};
pub use words::words;
