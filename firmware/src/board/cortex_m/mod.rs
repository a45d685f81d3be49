//! What every Cortex-M has.

pub mod clock;
pub mod guard;
pub mod identity;
pub mod semihosting;
pub mod watchdog;

pub(super) mod crash;
pub(super) mod retained;
pub(super) mod stopwatch;

mod calls;
mod fault_status;
mod interrupt;
#[cfg(armv6m)]
mod long_product;
