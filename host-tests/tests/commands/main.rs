//! The commands as they are called, the READMEs and what the report says.

mod cli;
mod closed_output;
mod demo_cli;
mod demo_port;
mod figures;
mod flash_cli;
mod flips_cli;
mod frontier;
mod fw_cli;
mod hygiene;
mod package;
mod pico_cli;
mod plan_cli;
mod process;
mod random_input;
mod readmes;
mod rooms;
mod simulate_cli;
#[path = "../support/mod.rs"]
mod support;
mod tolerance;
mod toolchain;
mod verify_board;
