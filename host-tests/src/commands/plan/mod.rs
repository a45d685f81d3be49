//! The planner held against the reference, and shown.

mod draw;
mod judge;
mod options;
mod study;
mod target;
mod words;

pub use draw::scenes;
pub use judge::{Exact, Outcome, judge};
pub use options::SceneOptions;
pub use study::{Case, DURATIONS, median, study, summary};
pub use target::{CHIPS, Chip, M3, M4F, PICO};
pub use words::words;
