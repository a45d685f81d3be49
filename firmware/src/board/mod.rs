//! The boards: the only place for registers, clocks, interrupts and `unsafe`.
//!
//! | room | what is in it |
//! |---|---|
//! | `main_loop` | the application of every board: its main loop, its log |
//! | [`lm3s6965evb`], [`mps2_an386`], `stm32f405`, `pico` | one board each: its clocks, pins and devices |
//! | `log` | where a real chip's log goes |
//! | `steps` | the steps of every arithmetic, which real chips have twice, in flash and in memory |
//! | [`cortex_m`] | what every Cortex-M has: the tick, the stack's guard, crash reports, memory kept across a reset |
//! | `panel_bus` | a panel's bus that an interrupt drives |
//! | `serial` | bytes in and out of any board's serial port |
//! | `register` | a device register |

pub mod cortex_m;
pub mod lm3s6965evb;
pub mod mps2_an386;
#[cfg(any(feature = "pico", feature = "stm32f405"))]
mod panel_bus;
#[cfg(feature = "pico")]
pub mod pico;
mod serial;
#[cfg(feature = "stm32f405")]
pub mod stm32f405;

#[cfg(any(feature = "pico", feature = "stm32f405"))]
mod log;
mod main_loop;
mod register;
#[cfg(any(feature = "pico", feature = "stm32f405"))]
mod steps;

#[cfg(not(any(feature = "pico", feature = "stm32f405")))] // which have a log of their own
use defmt_semihosting as _; // where the log goes

pub use main_loop::{Board, Plays};
