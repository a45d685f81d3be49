//! Where the firmware runs without a board.

pub mod boards;
pub mod budgets;
pub mod flash;
pub mod host;
pub mod pico;
pub mod process;
pub mod qemu;
pub mod toolchain;
