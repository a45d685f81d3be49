//! `cargo pico`: the firmware of the Raspberry Pi Pico as a file to be copied onto it.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::console::cli::say;
use crate::emulator::boards::PICO;
use crate::emulator::flash::flash_image;
use crate::emulator::toolchain::{self, target};
use crate::emulator::uf2::uf2;
use anyhow::Context;
use clap::Parser;

/// The file, and the one by which a board's drive says whose it is.
const FILE: &str = "pico.uf2";
const LABEL: &str = "INFO_UF2.TXT";
/// What the label of an RP2040 says.
const OURS: &str = "Board-ID: RPI-RP2";

/// Builds the firmware of the Raspberry Pi Pico as a file, and copies it onto the board if that shows itself as a drive.
#[derive(Debug, Parser)]
#[command(name = "cargo pico", after_help = "Example: cargo pico --drive /media/$USER/RPI-RP2")]
pub struct PicoOptions {
    /// The board's drive, which is there when BOOTSEL is held while the cable goes in [default: looked for]
    #[arg(long, value_name = "FOLDER", value_parser = drive)]
    drive: Option<PathBuf>,
}

pub fn run(options: &PicoOptions) -> anyhow::Result<()> {
    let (toolchain, _) = toolchain::set_up()?;
    let elf = fs::read(toolchain.build_for(&PICO)?)?;
    let (start, image) = flash_image(&elf)?;
    let file = target().join(FILE);
    let blocks = uf2(start, &image);
    fs::write(&file, &blocks).with_context(|| file.display().to_string())?;
    say(format_args!("{}: {} bytes of flash", file.display(), image.len()))?;
    let Some(drive) = options.drive.clone().or_else(|| mounted(&fs::read_to_string("/proc/mounts").ok()?)) else {
        say(
            "hold BOOTSEL while you plug the Pico in, then copy this file onto the drive RPI-RP2; it starts by itself",
        )?;
        return Ok(());
    };
    let to = drive.join(FILE);
    write_through(&to, &blocks).with_context(|| to.display().to_string())?;
    Ok(say(format_args!("copied to {}: the board starts by itself", drive.display()))?)
}

/// Returns once the drive has it. Not `fs::copy`, which sets the file's mode as well: a drive that root has mounted refuses that.
fn write_through(to: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = fs::File::create(to)?;
    file.write_all(bytes)?;
    file.sync_all()
}

fn drive(folder: &str) -> Result<PathBuf, String> {
    let label = fs::read_to_string(Path::new(folder).join(LABEL));
    match label {
        Ok(label) if label.contains(OURS) => Ok(folder.into()),
        Ok(_) => Err("this is the drive of another board".to_owned()),
        Err(_) => Err(format!("this is no board's drive: it has no {LABEL}")),
    }
}

/// The drive of an RP2040 among those that are mounted.
fn mounted(mounts: &str) -> Option<PathBuf> {
    let folders = mounts.lines().filter_map(|line| line.split(' ').nth(1));
    folders.map(|folder| folder.replace("\\040", " ")).find_map(|folder| drive(&folder).ok())
}
