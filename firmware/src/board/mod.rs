//! The boards. All registers, clocks, interrupts and `unsafe` code are here.
//!
//! | module | contents |
//! |---|---|
//! | `main_loop` | the main loop and the log lines of the application, for every board |
//! | [`lm3s6965evb`], `stm32f405`, `pico` | a board: its clocks, pins and devices |
//! | `log` | the output of the log on a real chip |
//! | [`cortex_m`] | parts for every Cortex-M: tick, stack, crash reports, retained record |
//! | `panel_bus` | a panel's bus that is driven by an interrupt |
//! | `serial` | the bytes received and sent by a serial port |
//! | `register` | a device register |
//!
//! The modules `stm32f405` and `pico` exist only with the features of these names; `log` and
//! `panel_bus` with either of them.
//!
//! To add a board with another Cortex-M3, M4 or M7:
//!
//! 1. Write `board/NAME/mod.rs`, modelled on [`lm3s6965evb`] (registers by hand) or `stm32f405` (a
//!    support library). Its `take` starts the clock and returns the [`Board`]. Panels: `OledI2c` on
//!    I2C driven by interrupts (`panel_bus`), `Ssd0323` on SPI, `NoDisplay`.
//! 2. Write `bin/NAME.rs`, one line. Add a `[[bin]]` in `Cargo.toml`, the start of its flash in
//!    `build.rs`, and its name in `protocol/to_host.rs`.
//! 3. If QEMU has the machine, add a row in `board.rs` and in `budgets.rs` of
//!    `host-tests/boards/src/`.
//!
//! Then run `cargo fw --check`, `cargo test -p host-tests --test boards` with `no_panic::`, then
//! with `qemu_plan:: qemu_host:: qemu_restart::`, then with `scenes::`; and on the board `cargo
//! verify-board --port auto`.

pub mod cortex_m;
pub mod lm3s6965evb;
#[cfg(any(feature = "pico", feature = "stm32f405"))]
#[cfg_attr(lcd, allow(dead_code))]
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

// The boards without a log of their own send it to the debugger.
#[cfg(not(any(feature = "pico", feature = "stm32f405")))]
use defmt_semihosting as _;

pub use main_loop::{Board, Plays};
