//! The serial link to a board, emulated or real: bytes to messages, and the port that they come through.

mod find;
mod inbox;
mod port;

pub use find::{AUTO, find};
pub use inbox::{Counts, Inbox, refusal};
pub use port::Port;
