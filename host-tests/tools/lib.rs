//! The host software: the commands, and the standards of comparison for the tests.
//!
//! A module imports only from the modules below it in this table. The folders of this package count
//! as modules.
//!
//! | module | content |
//! |---|---|
//! | `tests` | the tests, grouped by the thing they test |
//! | `tools/main.rs` | the program: runs the command that is named |
//! | [`commands`] | the commands: simulate, plan, prove, flips, count, report, figures, ... |
//! | [`demo`] | `cargo demo`: its own package, which is compiled without the other commands |
//! | [`oracle`] | known answers, hard cases, tolerances |
//! | [`emulator`] | the emulated boards: QEMU, toolchain and set-up, processes, budgets |
//! | [`emulator::link`] | the serial link: bytes to messages, and a real port |
//! | [`console`] | the shared console interface: options, errors, progress |
//! | [`cycles`] | the cost of a program on a Cortex-M, from QEMU's log |
//! | [`reference`](mod@reference) | the exact motion |
//! | [`vectors`] | many motions at once, in the host's vectors |

#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod commands;
pub mod oracle;
