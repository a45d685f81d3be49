//! The horizons of plans, proved.

mod frames;
mod known_answers;
mod options;
mod table;
mod words;

pub use frames::{Proof, follow};
pub use known_answers::known_answers;
pub use options::Options;
pub use table::{horizons, moving};
pub use words::{HEADING, row, width, words};
