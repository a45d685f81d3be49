//! The commands as processes, the READMEs, and the contents of the report.

mod cli;
mod demo_cli;
mod demo_port;
mod figures;
mod firmware_cli;
mod out_file;
mod random_input;
mod readmes;
mod release;
mod simulate_cli;
#[path = "../support/mod.rs"]
mod support;
mod verify_board;
