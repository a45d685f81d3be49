//! `cargo verify`: the set-up, then exactly `cargo test`.

use std::process::{Command, ExitCode, Stdio};
use std::time::Duration;

use clap::Parser;
use host_tests::console::cli;
use host_tests::emulator::{process, toolchain};

/// For every test, the compiling included, on a slow, busy machine.
const LIMIT: Duration = Duration::from_secs(3600);

/// Sets everything up and runs every test, those in QEMU included.
#[derive(Debug, Parser)]
#[command(name = "cargo verify")]
struct Arguments {}

fn main() -> ExitCode {
    if let Err(code) = cli::parse::<Arguments>() {
        return code;
    }
    if let Err(error) = toolchain::set_up() {
        return cli::refuse(error);
    }
    match test() {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// The tests' own output and exit code, unchanged.
fn test() -> Result<ExitCode, process::ProcessError> {
    let mut command = Command::new("cargo");
    command.arg("test").current_dir(toolchain::workspace()).stdin(Stdio::null());
    Ok(process::exit_code(process::spawn(&mut command, LIMIT)?.wait()?))
}
