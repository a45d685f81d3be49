//! `cargo flash-f4`: the firmware of the STM32F405, built, flashed by `probe-rs` and its log shown.

use std::os::unix::process::CommandExt;
use std::process::{Command, ExitCode};
use std::time::Duration;

use anyhow::bail;
use clap::Parser;
use host_tests::console::cli::{self, Refused};
use host_tests::emulator::boards::STM32F405;
use host_tests::emulator::process::{self, ProcessError};
use host_tests::emulator::toolchain;

/// The program that speaks to debug probes.
const PROBE_RS: &str = "probe-rs";
/// For it to say its version.
const LIMIT: Duration = Duration::from_secs(30);

/// Builds the firmware of the STM32F405, flashes it through a debug probe and shows its log until Ctrl-C.
#[derive(Debug, Parser)]
#[command(name = "cargo flash-f4", after_help = "Example: cargo flash-f4 --chip STM32F407VGTx")]
struct Arguments {
    /// The chip, by probe-rs's name: an STM32F405 or F407
    #[arg(long, default_value = "STM32F405RGTx")]
    chip: String,
}

fn main() -> ExitCode {
    cli::main(flash)
}

fn flash(arguments: &Arguments) -> anyhow::Result<()> {
    // Before the build, which takes its time.
    process::run(Command::new(PROBE_RS).arg("--version"), LIMIT).map_err(|error| match error {
        ProcessError::NotStarted { .. } => Refused::because(format_args!(
            "flashing needs {PROBE_RS}, which is not installed; see https://probe.rs/docs/getting-started/installation"
        )),
        error => Refused::because(error),
    })?;
    let elf = toolchain::ready().map_err(Refused::because)?.build_for(&STM32F405)?;
    // It takes the place of this process, so that the terminal, Ctrl-C and the exit code are its own.
    let error = Command::new(PROBE_RS).args(["run", "--chip", &arguments.chip]).arg(elf).exec();
    bail!(Refused::because(format_args!("cannot start {PROBE_RS}: {error}")))
}
