//! The host software: the commands, and the standards of comparison for the tests.
//!
//! The modules here are called rooms. A room imports only from the rooms below it in this table.
//!
//! | room | content |
//! |---|---|
//! | `main.rs` | the program: runs the command that is named |
//! | [`commands`] | the commands: demo, simulate, plan, prove, flips, count, report, figures, ... |
//! | [`emulator`] | the emulated boards: QEMU, toolchain and set-up, processes, budgets |
//! | [`link`] | the serial link: bytes to messages, and a real port |
//! | [`oracle`] | known answers, hard cases, tolerances |
//! | [`console`] | the shared console interface: options, errors, progress |

#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
#![allow(
    missing_docs,
    reason = "nobody builds on this package: what name and type say is not said again"
)]

pub mod commands;
pub mod console;
pub mod emulator;
pub mod link;
pub mod oracle;
