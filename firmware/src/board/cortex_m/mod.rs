//! What every Cortex-M has.

pub mod clock;
pub mod semihosting;

pub(super) mod crash;
pub(super) mod identity;
pub(super) mod interrupt;
pub(super) mod retained;
pub(super) mod watchdog;

mod calls;
mod guard;
#[cfg(armv6m)]
mod long_product;

pub(super) use clock::Clock;
pub(super) use guard::guard_stack;
pub(super) use identity::instruments;
