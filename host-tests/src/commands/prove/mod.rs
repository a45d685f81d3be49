//! The horizons of plans, proved.

mod horizon;
mod known_answers;
mod options;
mod table;

pub use horizon::{HEADING, Proof, follow, row, words};
pub use known_answers::known_answers;
pub use options::Options;
pub use table::{horizons, moving};
