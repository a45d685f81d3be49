//! `cargo flash-f4` with a stand-in for `probe-rs`, and without any.

use std::env;
use std::fs::{self, Permissions};
use std::io::{self, BufReader, Read};
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use firmware::protocol::Frame;
use host_tests::emulator::boards::STM32F405;
use host_tests::emulator::process::{self, Output};
use host_tests::emulator::toolchain;
use host_tests::link::Inbox;

use super::cli::{output, program};
use crate::support::LIMIT;

fn flash(arguments: &[&str], path: impl IntoIterator<Item = PathBuf>) -> Output {
    output(program("flash-f4").args(arguments).env("PATH", env::join_paths(path).expect("no colon in a folder's name")))
}

#[test]
fn without_probe_rs_it_says_what_is_missing() -> io::Result<()> {
    let nothing = tempfile::tempdir()?;
    let output = flash(&[], [nothing.path().to_owned()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stderr.starts_with("error: flashing needs probe-rs, which is not installed; see https://"));
    assert_eq!(output.stderr.lines().count(), 1);
    Ok(())
}

/// A folder with a program of this name, which says its arguments and ends with exit code 7.
fn stand_in(name: &str) -> io::Result<tempfile::TempDir> {
    let folder = tempfile::tempdir()?;
    let stand_in = folder.path().join(name);
    fs::write(&stand_in, "#!/bin/sh\necho \"$@\"\nexit 7\n")?;
    fs::set_permissions(&stand_in, Permissions::from_mode(0o755))?;
    Ok(folder)
}

/// With a stand-in found first.
fn path_with(folder: &tempfile::TempDir) -> Vec<PathBuf> {
    let rest = env::var_os("PATH").unwrap_or_default();
    [folder.path().to_owned()].into_iter().chain(env::split_paths(&rest)).collect()
}

#[test]
fn it_hands_the_image_to_probe_rs() -> io::Result<()> {
    let folder = stand_in("probe-rs")?;
    let output = flash(&["--chip", "STM32F407VGTx"], path_with(&folder));
    assert!(output.stdout.starts_with("run --chip STM32F407VGTx /"), "{output:?}");
    let image = output.stdout.split_whitespace().last().unwrap_or_default();
    assert!(image.ends_with("thumbv7em-none-eabihf/release/stm32f405"), "{image}");
    assert_eq!(fs::read(image)?.get(..4), Some(&b"\x7fELF"[..]));
    assert_eq!(output.status.code(), Some(7), "its exit code is the command's");
    Ok(())
}

/// What goes over USB is the program: QEMU, which gets nothing else, runs it.
#[test]
fn it_hands_the_bytes_of_the_flash_to_dfu_util() -> io::Result<()> {
    let folder = stand_in("dfu-util")?;
    let output = flash(&["--dfu"], path_with(&folder));
    assert!(output.stdout.starts_with("-d 0483:df11 -a 0 -s 0x08000000:leave -D /"), "{output:?}");
    assert_eq!(output.status.code(), Some(7), "its exit code is the command's");
    let bin = output.stdout.split_whitespace().last().unwrap_or_default();
    let mut qemu = Command::new(toolchain::ready().expect("the tools").qemu());
    qemu.args(["-machine", STM32F405.machine, "-cpu", STM32F405.cpu, "-display", "none", "-kernel", bin]);
    qemu.args(["-serial", "null", "-serial", "null", "-serial", "stdio"]).stdin(Stdio::null());
    let mut qemu = process::spawn(qemu.stdout(Stdio::piped()).stderr(Stdio::null()), LIMIT).expect("QEMU");
    let mut inbox = Inbox::default();
    let bytes = BufReader::new(qemu.stdout.take().expect("its serial port")).bytes();
    let mut frames = bytes.map_while(Result::ok).filter_map(|byte| inbox.take(byte)?.read::<Frame>());
    assert_eq!(frames.next().map(|frame| frame.step), Some(1));
    Ok(())
}
