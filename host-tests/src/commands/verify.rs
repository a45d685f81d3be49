//! `cargo verify`: the set-up, the firmware, then exactly `cargo test`.

use std::env;
use std::process::{Command, ExitCode, Stdio};
use std::thread::available_parallelism;
use std::time::Duration;

use crate::emulator::{process, toolchain};
use clap::Parser;

/// For every test, the compiling included, on a slow, busy machine; and for the long ones too.
const LIMITS: [Duration; 2] = [Duration::from_secs(3600), Duration::from_secs(12 * 3600)];

/// Sets everything up and runs every test, those in QEMU included.
#[derive(Debug, Parser)]
#[command(name = "cargo verify", after_help = "Example: cargo verify --long")]
pub struct VerificationOptions {
    /// Run the tests that take hours, too
    #[arg(long)]
    long: bool,
}

/// How many tests run side by side. Unless the user has set it, twice as many as there are processors: many wait for an
/// emulator or a clock.
const THREADS: &str = "RUST_TEST_THREADS";

/// The tests' own output and exit code, unchanged.
pub fn run(options: &VerificationOptions) -> anyhow::Result<ExitCode> {
    let (toolchain, _) = toolchain::set_up()?;
    toolchain::set_up_pico()?;
    toolchain.build_ahead()?;
    let mut command = Command::new("cargo");
    command.arg("test").current_dir(toolchain::workspace()).stdin(Stdio::null());
    if options.long {
        command.args(["--", "--include-ignored"]);
    }
    if env::var_os(THREADS).is_none() {
        command.env(THREADS, (2 * available_parallelism()?.get()).to_string());
    }
    Ok(process::exit_code(process::spawn(&mut command, LIMITS[usize::from(options.long)])?.wait()?))
}
