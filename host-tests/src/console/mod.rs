//! How every command talks: its options, its errors, its progress.

pub mod cli;
pub mod progress;
