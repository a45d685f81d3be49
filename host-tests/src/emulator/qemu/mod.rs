//! The emulated board as an instrument: a machine started with a firmware, its serial link, log, buttons and panel.
//!
//! Every wait ends: at the latest when the machine's time limit ends QEMU.

mod debugger;
mod log;
mod machine;
mod monitor;
mod screenshot;

pub use debugger::Register;
pub use log::{LogDecoder, LogLine};
pub use machine::{Clock, Machine, Settings};
pub use screenshot::{HEIGHT, Screenshot, WIDTH};
