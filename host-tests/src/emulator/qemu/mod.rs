//! The emulated board as an instrument: a machine started with a firmware, its serial link, log, buttons and panel.
//!
//! Every wait ends: at the latest when the machine's time limit ends QEMU, which closes all its connections.

mod gdb;
mod lockstep;
mod log;
mod machine;
mod qmp;
mod screenshot;
mod serial;

pub use lockstep::{Lockstep, Register};
pub use log::{Log, LogDecoder, LogLine};
pub(crate) use machine::check_folder;
pub use machine::{Clock, Machine, Settings};
pub use screenshot::{HEIGHT, Screenshot, WIDTH};
pub use serial::Serial;
