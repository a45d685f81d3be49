//! `cargo setup`: brings what the firmware needs, and says what was found and what was done.

use std::process::ExitCode;

use clap::Parser;
use host_tests::console::cli::{self, say};
use host_tests::emulator::toolchain;

/// Finds or brings all that builds and runs the firmware: the ARM core library, QEMU, and rp2040js for the Pico.
#[derive(Debug, Parser)]
#[command(name = "cargo setup")]
struct Arguments {}

fn main() -> ExitCode {
    cli::main(|_: &Arguments| {
        let (toolchain, mut done) = toolchain::set_up()?;
        say(toolchain)?;
        let (emulator, more) = toolchain::set_up_pico()?;
        say(emulator)?;
        done.extend(more);
        match done.as_slice() {
            [] => say("nothing had to be done")?,
            steps => steps.iter().try_for_each(|step| say(format_args!("done: {step}")))?,
        }
        Ok(())
    })
}
