//! `cargo setup`: brings what the firmware needs, and says what was found and what was done.

use std::process::ExitCode;

use clap::Parser;
use host_tests::console::cli;
use host_tests::emulator::toolchain;

/// Finds or brings all that builds and runs the firmware: the ARM core library and QEMU.
#[derive(Debug, Parser)]
#[command(name = "cargo setup")]
struct Arguments {}

fn main() -> ExitCode {
    if let Err(code) = cli::parse::<Arguments>() {
        return code;
    }
    match toolchain::set_up() {
        Ok((toolchain, done)) => {
            println!("{toolchain}");
            match done.as_slice() {
                [] => println!("nothing had to be done"),
                steps => steps.iter().for_each(|step| println!("done: {step}")),
            }
            ExitCode::SUCCESS
        }
        Err(error) => cli::refuse(error),
    }
}
