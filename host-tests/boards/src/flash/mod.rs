//! `cargo pico` and `cargo flash-f4`: transfer the firmware to a board, as a file or by a flashing
//! program.

pub mod image;

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use clap::Parser;

use crate::board::{STM32F405, pico_with};
use crate::console::cli::{Refused, choice, complain, say};
use crate::flash::image::{flash_image, uf2};
use crate::link::{running_board, touch};
use crate::out_file;
use crate::toolchain::{self, Toolchain, target};
use firmware::graphics::PanelName;

/// Returns the name of the firmware's file, in the target folder and on a board's drive.
pub fn file_name(panel: PanelName) -> String {
    match panel {
        PanelName::Oled => "pico.uf2".to_owned(),
        panel => format!("pico-{}.uf2", panel.name()),
    }
}

const LABEL: &str = "INFO_UF2.TXT";
const OURS: &str = "Board-ID: RPI-RP2";
/// The line in the label of an RP2350, whose boot loader ignores a file for the RP2040.
const PICO_2: &str = "Board-ID: RP2350";
/// The drive of a board on Linux, also if it is not mounted.
const DEVICE: &str = "/dev/disk/by-label/RPI-RP2";

const DRIVE_TYPE: &str = "vfat";
/// The enumeration takes a second, and the desktop's mounting another.
const MOUNTING: Duration = Duration::from_secs(10);
const LOOK: Duration = Duration::from_millis(250);

/// Builds the firmware of the Raspberry Pi Pico as target/pico.uf2, and copies it onto the board if
/// one is connected: as the drive RPI-RP2, or running this firmware at a USB port.
#[derive(Debug, Parser)]
#[command(name = "cargo pico", after_help = panels())]
pub struct PicoOptions {
    /// The board's drive; it appears if BOOTSEL is held while the cable is plugged in [default: the
    /// mounted drive RPI-RP2]
    #[arg(long, value_name = "FOLDER", value_parser = drive)]
    drive: Option<PathBuf>,
    /// The panel
    #[arg(
        long,
        value_name = "NAME",
        default_value = PanelName::Oled.name(),
        value_parser = choice(PanelName::ALL.iter().copied(), PanelName::name),
        hide_possible_values = true,
    )]
    panel: PanelName,
}

/// Returns the panels with their names, for the help.
fn panels() -> String {
    let line = |panel: &PanelName| format!("\n  {:10} {}", panel.name(), panel.text());
    let lines: String = PanelName::ALL.iter().map(line).collect();
    format!("Panels:{lines}\n\nExample: cargo pico --panel lcd-1.3")
}

/// Builds the firmware of the Raspberry Pi Pico for a panel. Returns the number of bytes in the
/// flash, and the file.
pub fn uf2_file(toolchain: &Toolchain, panel: PanelName) -> anyhow::Result<(usize, PathBuf)> {
    let (start, image) = flash_image(&fs::read(toolchain.build_for(&pico_with(panel))?)?)?;
    let file = target().join(file_name(panel));
    out_file::write("the firmware", &file, uf2(start, &image))?;
    Ok((image.len(), file))
}

/// Builds the UF2 file and copies it to the drive of the options, else to the mounted drive of an
/// RP2040, else to the only board that runs this firmware at a USB port. A drive that cannot take
/// the file is refused before the build, which takes minutes.
pub fn pico(options: &PicoOptions) -> anyhow::Result<()> {
    if options.drive.is_none() {
        find_drive()?;
    }
    let (bytes, file) = uf2_file(&toolchain::set_up_to_flash()?, options.panel)?;
    say(format_args!("{}: {bytes} bytes of flash", file.display()))?;

    let blocks = fs::read(&file)?;
    let drive = match options
        .drive
        .clone()
        .map_or_else(find_drive, |drive| Ok(Some(drive)))?
    {
        Some(drive) => drive,
        None => {
            let ports = serialport::available_ports().unwrap_or_default();
            let Some(port) = running_board(&ports) else {
                const BY_HAND: &str = "hold BOOTSEL while you plug the Pico in, then copy this \
                                       file onto the drive RPI-RP2; it starts by itself";
                return Ok(say(BY_HAND)?);
            };
            restart_in_boot_loader(port)?
        }
    };
    let to = drive.join(file_name(options.panel));

    // Wait until the drive has the data. `fs::copy` is not suitable, because it also sets the
    // file's mode, which a drive mounted by root refuses.
    let written = fs::File::create(&to)
        .and_then(|mut file| file.write_all(&blocks).and_then(|()| file.sync_all()));
    written.with_context(|| to.display().to_string())?;
    Ok(say(format_args!(
        "copied to {}: the board starts by itself",
        drive.display()
    ))?)
}

fn restart_in_boot_loader(port: &str) -> anyhow::Result<PathBuf> {
    say(format_args!(
        "{port}: the board restarts in its boot loader"
    ))?;
    touch(port).map_err(Refused::because)?;
    let since = Instant::now();
    loop {
        let found = find_drive();
        if let Ok(Some(drive)) = found {
            return Ok(drive);
        }
        if since.elapsed() >= MOUNTING {
            found?;
            bail!(Refused::because(
                "the board waits in its boot loader, but its drive RPI-RP2 does not appear: mount \
                 it, then name the folder with --drive"
            ))
        }
        sleep(LOOK);
    }
}

/// Returns the mounted drive of an RP2040. The drive of a Pico 2 and an unmounted drive are
/// refused.
fn find_drive() -> Result<Option<PathBuf>, Refused> {
    let folders = match fs::read_to_string("/proc/mounts") {
        Ok(mounts) => mounted(&mounts),
        Err(_) => volumes(),
    };
    let drives: Vec<_> = folders.iter().map(|folder| drive(folder)).collect();
    if let Some(drive) = drives.iter().flatten().next() {
        return Ok(Some(drive.clone()));
    }
    if let Some(pico_2) = drives
        .into_iter()
        .filter_map(Result::err)
        .find(|why| *why == IS_PICO_2)
    {
        return Err(Refused::because(pico_2));
    }
    if Path::new(DEVICE).exists() {
        return Err(Refused::because(format_args!(
            "the board's drive is not mounted: run udisksctl mount -b {DEVICE}, then this again"
        )));
    }
    Ok(None)
}

const IS_PICO_2: &str = "this board is a Pico 2 (RP2350); the firmware is for the Pico (RP2040)";

fn drive(folder: &str) -> Result<PathBuf, String> {
    match fs::read_to_string(Path::new(folder).join(LABEL)) {
        Ok(label) if label.contains(OURS) => Ok(folder.into()),
        Ok(label) if label.contains(PICO_2) => Err(IS_PICO_2.to_owned()),
        Ok(_) => Err("this is the drive of another board".to_owned()),
        Err(_) if !Path::new(folder).is_dir() => Err("there is no such folder".to_owned()),
        Err(_) => Err(format!("this is no board's drive: it has no {LABEL}")),
    }
}

/// Returns the mounted drives of the boot loader's type on Linux. No other drive is read, because a
/// network file system whose server is gone would never answer.
fn mounted(mounts: &str) -> Vec<String> {
    let folder = |line: &str| {
        let mut fields = line.split(' ').skip(1);
        let folder = fields.next()?;
        // The system writes a space in a path as `\040`.
        (fields.next()? == DRIVE_TYPE).then(|| folder.replace("\\040", " "))
    };
    mounts.lines().filter_map(folder).collect()
}

fn volumes() -> Vec<String> {
    let entries = fs::read_dir("/Volumes").into_iter().flatten().flatten();
    entries
        .map(|entry| entry.path().display().to_string())
        .collect()
}

const CHIPS: [&str; 4] = ["STM32F405", "STM32F407", "STM32F415", "STM32F417"];

const EXAMPLES: &str = "Examples:
  cargo flash-f4 --chip STM32F407VGTx
  cargo flash-f4 --dfu

To flash over USB, first connect BOOT0 with 3.3 V and press reset. Afterwards take the wire off and
press reset.";

/// Builds the firmware of the STM32F405 and flashes it: with a debug probe (then shows the log
/// until Ctrl-C), or over USB.
#[derive(Debug, Parser)]
#[command(name = "cargo flash-f4", after_help = EXAMPLES)]
pub struct FlashOptions {
    /// The chip, an STM32F405, F407, F415 or F417, by probe-rs's name
    #[arg(long, default_value = "STM32F405RGTx", value_parser = chip)]
    chip: String,
    /// Flash without a probe, over the chip's built-in USB loader
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
        Err(format!("the firmware runs on {}", CHIPS.join(", ")))
    }
}

/// Builds the firmware of the STM32F405 and flashes it. A missing program is refused; nothing is
/// installed.
pub fn stm32f405(options: &FlashOptions) -> anyhow::Result<()> {
    let (program, source) = if options.dfu {
        (
            "dfu-util",
            "https://dfu-util.sourceforge.net, in Debian: apt-get install dfu-util",
        )
    } else {
        (
            "probe-rs",
            "cargo install probe-rs-tools --locked, or https://probe.rs",
        )
    };

    if toolchain::find(program).is_none() {
        bail!(Refused::because(format_args!(
            "flashing needs {program}, which is not installed: {source}"
        )));
    }
    let elf = toolchain::set_up_to_flash()?.build_for(&STM32F405)?;

    let mut command = Command::new(program);

    if options.dfu {
        let (start, image) = flash_image(&fs::read(&elf)?)?;
        let file = elf.with_extension("bin");
        fs::write(&file, image).with_context(|| file.display().to_string())?;

        // The options select ST's loader and its flash. They do not contain `:leave`, because a
        // program started by the loader finds its USB interrupt pending, and `dfu-util` fails when
        // the device is gone.
        command
            .args([
                "-d",
                "0483:df11",
                "-a",
                "0",
                "-s",
                &format!("{start:#010x}"),
                "-D",
            ])
            .arg(file);
        complain(format_args!("{command:?}"));
    } else {
        command.args(["run", "--chip", &options.chip]).arg(elf);
    }

    let start = |error| Refused::because(format_args!("cannot start {program}: {error}"));
    if options.dfu {
        let mut child = command.stdout(Stdio::piped()).spawn().map_err(start)?;
        let output = child.stdout.take().context("dfu-util has no output")?;
        let is_written = copy_until_written(BufReader::new(output), &mut std::io::stdout())?;
        let status = child.wait()?;
        if !is_written {
            bail!("{program} did not report {DOWNLOADED:?} ({status})");
        }
        return Ok(say(
            "the program is in the flash: take the wire off BOOT0, then press reset",
        )?);
    }

    // The flashing program replaces this process, so that it has the terminal and Ctrl-C.
    bail!(start(command.exec()))
}

/// The line that `dfu-util` prints when the whole file is in the flash.
///
/// The exit code is not reliable: if the device disappears before it has answered a status request,
/// the code is 74 (EX_IOERR) although everything is written.
const DOWNLOADED: &str = "File downloaded successfully";

/// Copies the output of `dfu-util`. Returns true if it reports that the file is written.
fn copy_until_written(mut output: impl BufRead, to: &mut impl Write) -> std::io::Result<bool> {
    let mut is_written = false;
    let mut line = Vec::new();

    // A progress bar ends in a carriage return, and its lines are long, so all available bytes are
    // shown at once.
    loop {
        let bytes = output.fill_buf()?;
        let count = bytes.len();
        if count == 0 {
            return Ok(is_written);
        }
        to.write_all(bytes)?;
        to.flush()?;
        for &byte in bytes {
            if byte == b'\n' || byte == b'\r' {
                line.clear();
            } else {
                line.push(byte);
                is_written |= line.ends_with(DOWNLOADED.as_bytes());
            }
        }
        output.consume(count);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_drives_of_the_boot_loaders_type_are_read() {
        let mounts = "/dev/sda1 / ext4 rw 0 0\n/dev/sdb1 /media/my\\040name/RPI-RP2 vfat rw 0 0\n\
                      server:/home /home nfs4 rw 0 0\n";
        assert_eq!(mounted(mounts), ["/media/my name/RPI-RP2"]);
    }

    #[test]
    fn a_drive_is_known_by_its_label() {
        let folder = tempfile::tempdir().expect("a folder");
        let name = folder.path().display().to_string();
        let label = |board: &str| {
            let text = format!("UF2 Bootloader v1.0\n{board}\n");
            fs::write(folder.path().join(LABEL), text).expect("a file");
            drive(&name)
        };
        assert_eq!(label(OURS), Ok(folder.path().to_owned()));
        assert_eq!(label(PICO_2), Err(IS_PICO_2.to_owned()));
        assert!(label("Board-ID: SAMD21").is_err_and(|why| why.contains("another board")));
        assert_eq!(drive("/nowhere"), Err("there is no such folder".to_owned()));
    }

    #[test]
    fn a_download_is_judged_by_the_tools_own_line() {
        let judged = |text: &str| {
            let mut shown = Vec::new();
            let is_written = copy_until_written(text.as_bytes(), &mut shown).expect("memory");
            assert_eq!(shown, text.as_bytes());
            is_written
        };
        assert!(judged(
            "Download\t[====] 100%  237060 bytes\rDownload done.\nFile downloaded successfully\n"
        ));
        assert!(!judged("Download\t[==   ] 40%\rError during download\n"));
    }
}
