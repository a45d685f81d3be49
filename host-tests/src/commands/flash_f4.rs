//! `cargo flash-f4`: the firmware of the STM32F405, built and flashed, through a debug probe or over the chip's own USB loader.

use std::io;
use std::os::unix::process::CommandExt;
use std::process::Command;
use std::time::Duration;

use crate::console::cli::{Refused, complain};
use crate::emulator::boards::STM32F405;
use crate::emulator::flash::flash_image;
use crate::emulator::process;
use crate::emulator::toolchain;
use anyhow::{Context, bail};
use clap::Parser;

/// For the program that flashes to say its version.
const LIMIT: Duration = Duration::from_secs(30);
/// Chips alike in all that the firmware uses.
const CHIPS: [&str; 4] = ["STM32F405", "STM32F407", "STM32F415", "STM32F417"];

/// Builds the firmware of the STM32F405 and flashes it: through a debug probe, whose log it shows until Ctrl-C, or by USB.
#[derive(Debug, Parser)]
#[command(
    name = "cargo flash-f4",
    after_help = "Examples:\n  cargo flash-f4 --chip STM32F407VGTx\n  cargo flash-f4 --dfu    (BOOT0 at 3.3 V, then reset: the chip waits at its USB port; afterwards the wire off, then reset)"
)]
pub struct FlashOptions {
    /// The chip, by probe-rs's name: an STM32F405 or F407
    #[arg(long, default_value = "STM32F405RGTx", value_parser = chip)]
    chip: String,
    /// Without a probe, over the USB loader that the chip has built in
    #[arg(long, conflicts_with = "chip")]
    dfu: bool,
}

/// A chip that the firmware is for.
fn chip(name: &str) -> Result<String, String> {
    let is_it = CHIPS.iter().any(|chip| name.to_ascii_uppercase().starts_with(chip));
    if is_it { Ok(name.to_owned()) } else { Err(format!("the firmware is for {}", CHIPS.join(", "))) }
}

pub fn run(options: &FlashOptions) -> anyhow::Result<()> {
    let (program, source) = if options.dfu {
        ("dfu-util", "https://dfu-util.sourceforge.net, in Debian: apt-get install dfu-util")
    } else {
        ("probe-rs", "https://probe.rs/docs/getting-started/installation")
    };
    // Before the build, which takes its time.
    process::run(Command::new(program).arg("--version"), LIMIT).map_err(|error| match error.kind() {
        io::ErrorKind::TimedOut => Refused::because(error),
        _ => Refused::because(format_args!("flashing needs {program}, which is not installed; see {source}")),
    })?;
    let elf = toolchain::ready()?.build_for(&STM32F405)?;
    let mut command = Command::new(program);
    if options.dfu {
        let (start, image) = flash_image(&std::fs::read(&elf)?)?;
        let file = elf.with_extension("bin");
        std::fs::write(&file, image).with_context(|| file.display().to_string())?;
        // ST's loader, its flash, and the program started at the end.
        command.args(["-d", "0483:df11", "-a", "0", "-s", &format!("{start:#010x}:leave"), "-D"]).arg(file);
        complain(format_args!("{command:?}"));
    } else {
        command.args(["run", "--chip", &options.chip]).arg(elf);
    }
    // It takes the place of this process, so that the terminal, Ctrl-C and the exit code are its own.
    let error = command.exec();
    bail!(Refused::because(format_args!("cannot start {program}: {error}")))
}
