//! `cargo pico` and `cargo flash-f4`: the firmware brought onto a board, as a file or by a program that flashes.

use std::fs;
use std::io::Write;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, bail};
use clap::Parser;

use crate::console::cli::{Refused, complain, say};
use crate::emulator::boards::{PICO, STM32F405};
use crate::emulator::flash::{flash_image, uf2};
use crate::emulator::toolchain::{self, target};

/// The file, and the one by which a board's drive says whose it is.
const FILE: &str = "pico.uf2";
const LABEL: &str = "INFO_UF2.TXT";
/// What the label of an RP2040 says.
const OURS: &str = "Board-ID: RPI-RP2";

/// Builds the firmware of the Raspberry Pi Pico as a file, and copies it onto the board if that shows itself as a drive.
#[derive(Debug, Parser)]
#[command(
    name = "cargo pico",
    after_help = "Example: cargo pico --drive /media/$USER/RPI-RP2"
)]
pub struct PicoOptions {
    /// The board's drive, which is there when BOOTSEL is held while the cable goes in [default: looked for]
    #[arg(long, value_name = "FOLDER", value_parser = drive)]
    drive: Option<PathBuf>,
}

pub fn pico(options: &PicoOptions) -> anyhow::Result<()> {
    let toolchain = toolchain::set_up()?;
    let (start, image) = flash_image(&fs::read(toolchain.build_for(&PICO)?)?)?;
    let (file, blocks) = (target().join(FILE), uf2(start, &image));
    fs::write(&file, &blocks).with_context(|| file.display().to_string())?;
    say(format_args!(
        "{}: {} bytes of flash",
        file.display(),
        image.len()
    ))?;
    let Some(drive) = options
        .drive
        .clone()
        .or_else(|| mounted(&fs::read_to_string("/proc/mounts").ok()?))
    else {
        const BY_HAND: &str = "hold BOOTSEL while you plug the Pico in, then copy this file onto the drive RPI-RP2; it starts by itself";
        return Ok(say(BY_HAND)?);
    };
    let to = drive.join(FILE);
    // Until the drive has it. Not `fs::copy`, which sets the file's mode as well: a drive that root has mounted refuses that.
    let written = fs::File::create(&to)
        .and_then(|mut file| file.write_all(&blocks).and_then(|()| file.sync_all()));
    written.with_context(|| to.display().to_string())?;
    Ok(say(format_args!(
        "copied to {}: the board starts by itself",
        drive.display()
    ))?)
}

fn drive(folder: &str) -> Result<PathBuf, String> {
    match fs::read_to_string(Path::new(folder).join(LABEL)) {
        Ok(label) if label.contains(OURS) => Ok(folder.into()),
        Ok(_) => Err("this is the drive of another board".to_owned()),
        Err(_) => Err(format!("this is no board's drive: it has no {LABEL}")),
    }
}

/// The drive of an RP2040 among those that are mounted.
fn mounted(mounts: &str) -> Option<PathBuf> {
    let folders = mounts.lines().filter_map(|line| line.split(' ').nth(1));
    folders
        .map(|folder| folder.replace("\\040", " "))
        .find_map(|folder| drive(&folder).ok())
}

/// Chips alike in all that the firmware uses.
const CHIPS: [&str; 4] = ["STM32F405", "STM32F407", "STM32F415", "STM32F417"];

const EXAMPLES: &str = "Examples:
  cargo flash-f4 --chip STM32F407VGTx
  cargo flash-f4 --dfu    (BOOT0 at 3.3 V, then reset: the chip waits at its USB port; afterwards the wire off, then reset)";

/// Builds the firmware of the STM32F405 and flashes it: through a debug probe, whose log it shows until Ctrl-C, or by USB.
#[derive(Debug, Parser)]
#[command(name = "cargo flash-f4", after_help = EXAMPLES)]
pub struct FlashOptions {
    /// The chip, by probe-rs's name: an STM32F405 or F407
    #[arg(long, default_value = "STM32F405RGTx", value_parser = chip)]
    chip: String,
    /// Without a probe, over the USB loader that the chip has built in
    #[arg(long, conflicts_with = "chip")]
    dfu: bool,
}

fn chip(name: &str) -> Result<String, String> {
    let is_it = CHIPS
        .iter()
        .any(|chip| name.to_ascii_uppercase().starts_with(chip));
    if is_it {
        Ok(name.to_owned())
    } else {
        Err(format!("the firmware is for {}", CHIPS.join(", ")))
    }
}

pub fn stm32f405(options: &FlashOptions) -> anyhow::Result<()> {
    let (program, source) = if options.dfu {
        (
            "dfu-util",
            "https://dfu-util.sourceforge.net, in Debian: apt-get install dfu-util",
        )
    } else {
        (
            "probe-rs",
            "https://probe.rs/docs/getting-started/installation",
        )
    };
    // Before the build, which takes its time.
    if toolchain::find(program).is_none() {
        bail!(Refused::because(format_args!(
            "flashing needs {program}, which is not installed; see {source}"
        )));
    }
    let elf = toolchain::ready()?.build_for(&STM32F405)?;
    let mut command = Command::new(program);
    if options.dfu {
        let (start, image) = flash_image(&fs::read(&elf)?)?;
        let file = elf.with_extension("bin");
        fs::write(&file, image).with_context(|| file.display().to_string())?;
        // ST's loader, its flash, and the program started at the end.
        command
            .args([
                "-d",
                "0483:df11",
                "-a",
                "0",
                "-s",
                &format!("{start:#010x}:leave"),
                "-D",
            ])
            .arg(file);
        complain(format_args!("{command:?}"));
    } else {
        command.args(["run", "--chip", &options.chip]).arg(elf);
    }
    // It takes the place of this process, so that the terminal, Ctrl-C and the exit code are its own.
    let error = command.exec();
    bail!(Refused::because(format_args!(
        "cannot start {program}: {error}"
    )))
}
