//! The commands, one module each.

pub mod count;
pub mod emulated;
pub mod figures;
pub mod flash;
pub mod flips;
pub mod plan;
pub mod prove;
pub mod release;
pub mod report;
pub mod simulate;
pub mod table;
pub mod verify_board;
pub mod web;
