//! An emulated board as a test instrument: a machine that runs a firmware, with its serial link,
//! log, buttons and panel.
//!
//! Every wait ends, because the machine's time limit ends QEMU.

mod debugger;
mod log;
mod machine;
mod monitor;
mod screenshot;

pub use debugger::{Register, send_packet, take_reply};
pub use log::{LogDecoder, LogLine};
pub use machine::{Clock, Machine, MachineSettings};
pub use screenshot::{HEIGHT, Screenshot, WIDTH};
