//! The console interface of all commands: options, numbers, errors, progress.

#![forbid(unsafe_code)]
#![deny(clippy::print_stdout, clippy::print_stderr)]

pub mod cli;
pub mod number;
pub mod progress;
