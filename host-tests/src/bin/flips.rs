//! `cargo flips`: the map of flips.

use std::process::ExitCode;

use host_tests::commands::flips;
use host_tests::console::cli;

fn main() -> ExitCode {
    cli::main(flips::run)
}
