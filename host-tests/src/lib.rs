//! The host's side: the commands, and what the tests hold every number against.
//!
//! A room imports only from the rooms below it in this table.
//!
//! | room | what is in it |
//! |---|---|
//! | `main.rs` | the command of each name |
//! | [`commands`] | what the commands do: demo, simulate, plan, prove, flips, count, report, figures, verify-board |
//! | [`emulator`] | the emulated boards: QEMU, toolchain and set-up, processes, budgets |
//! | [`link`] | the serial link: bytes to messages, and a real port |
//! | [`oracle`] | known answers, hard cases, tolerances |
//! | [`console`] | how every command talks: options, errors, progress |

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
