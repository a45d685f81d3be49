//! The boards: the only place for registers, clocks, interrupts and `unsafe`.

pub mod lm3s6965evb;
pub mod mps2_an386;
pub mod semihosting;
#[cfg(feature = "stm32f405")]
pub mod stm32f405;

mod calls;
mod clock;
mod crash;
mod guard;
mod interrupt;
mod main_loop;
mod receiver;
mod register;
mod soft_float;
mod survival;
mod transmitter;
mod watchdog;

#[cfg(not(feature = "stm32f405"))] // which has a log of its own
use defmt_semihosting as _; // where the log goes

pub use clock::{Clock, cycles};
pub use guard::guard_stack;
pub use main_loop::{application, run};
pub use receiver::Receiver;
pub use transmitter::{Timeout, Transmitter};
pub use watchdog::{TwoStage, Watchdog};
