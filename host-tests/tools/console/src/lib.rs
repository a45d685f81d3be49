//! The console interface of all commands: options, numbers, errors, progress.

#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]
#![allow(
    missing_docs,
    reason = "nobody builds on this package: what name and type say is not said again"
)]

pub mod cli;
pub mod number;
pub mod progress;
