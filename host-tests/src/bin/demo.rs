//! `cargo demo`: the double pendulum on the emulated panel, live in the terminal.

use std::process::ExitCode;

use host_tests::commands::demo;
use host_tests::console::cli;

fn main() -> ExitCode {
    cli::main(|options| demo::run(options).map(cli::verdict))
}
