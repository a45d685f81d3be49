//! The commands. A command is a function of its options, which [`console::cli::main`] parses. It
//! prints its result to stdout. An error is returned and not printed; that function prints it.
//!
//! The command of most modules is `run`. [`emulated`] has several. [`table`] has
//! none: it formats the tables of the others.

pub mod count;
pub mod emulated;
pub mod figures;
pub mod flips;
pub mod plan;
pub mod prove;
pub mod release;
pub mod report;
pub mod simulate;
pub mod table;
pub mod verify_board;
pub mod web;
