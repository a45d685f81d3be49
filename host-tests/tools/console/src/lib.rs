//! The console interface of all commands: options, errors, progress.

pub mod cli;
pub mod progress;
