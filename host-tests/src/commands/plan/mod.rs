//! The planner held against the reference, and shown.

mod draw;
mod fit;
mod judge;
mod options;
mod study;
mod tables;
mod target;
mod words;

pub use draw::scenes;
pub use fit::{FOLLOWED, Sample, fit, margins};
pub use judge::{Verdict, judge, reference_error};
pub use options::Options;
pub use study::{Case, Class, DURATIONS, GROSS, median, study};
pub use tables::{broken, classes};
pub use target::{CHIPS, Chip, M3, M4F};
pub use words::words;
