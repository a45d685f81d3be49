//! The motion itself, apart from any frame of it: settings, stepping, planning.

pub mod misprinted;
pub mod planner;
pub mod settings;
pub mod simulation;
