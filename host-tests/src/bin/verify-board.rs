//! `cargo verify-board`: a board in the hand, verified and reported.

use std::process::ExitCode;

use host_tests::commands::verify_board;
use host_tests::console::cli;

fn main() -> ExitCode {
    cli::main(|options| verify_board::run(options).map(cli::verdict))
}
