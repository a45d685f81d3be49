//! The console interface of all commands: options, numbers, errors, progress.

pub mod cli;
pub mod number;
pub mod progress;
