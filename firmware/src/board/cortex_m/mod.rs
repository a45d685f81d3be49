//! What every Cortex-M has.

pub mod clock;
pub mod semihosting;

pub(super) mod crash;
pub(super) mod guard;
pub(super) mod identity;
pub(super) mod interrupt;
pub(super) mod retained;
pub(super) mod watchdog;

mod calls;
#[cfg(armv6m)]
mod long_product;
