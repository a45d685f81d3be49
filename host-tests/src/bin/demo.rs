//! `cargo demo`: the double pendulum on the emulated panel, live in the terminal.

use std::process::ExitCode;

use host_tests::commands::demo;
use host_tests::console::cli;

fn main() -> ExitCode {
    let options = match cli::parse::<demo::Options>() {
        Ok(options) => options,
        Err(code) => return code,
    };
    match demo::run(&options) {
        Err(unavailable) => cli::refuse(unavailable),
        Ok(Ok(true)) => ExitCode::SUCCESS,
        Ok(Ok(false)) => ExitCode::FAILURE,
        Ok(Err(error)) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
