//! `cargo fw`, `cargo flash-f4` with a fake `probe-rs` and without one, and `cargo pico`.

use std::env;
use std::fs::{self, Permissions};
use std::io::{self, BufRead, BufReader, Read};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};

use boards::flash::image::flash_image;
use boards::link::Inbox;
use boards::process::{self, Output};
use boards::toolchain;
use boards::{PICO, STM32F405};
use firmware::protocol::ToHost;
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use super::cli::{output, program};
use crate::support::LIMIT;

fn fw(arguments: &[&str]) -> Output {
    output(program("fw").args(arguments))
}

#[test]
fn a_program_without_end_is_stopped_with_success_on_request() {
    let output = fw(&["lm3s6965evb", "--seconds", "5"]);
    assert_eq!(output.status.code(), Some(0), "{}", output.stderr);
    assert!(
        output.stdout.contains("boot: lm3s6965evb"),
        "{}",
        output.stdout
    );
    assert_eq!(
        output.stderr.lines().last(),
        Some("stopped after 5 s, as requested")
    );
    assert_eq!(
        fw(&["measure", "--seconds", "600"]).status.code(),
        Some(1),
        "a program that lacks its request fails"
    );
}

/// Ends the command by a signal once the board runs. Returns the exit code.
fn ended_by(signal: Signal, temporary: &Path) -> Option<i32> {
    let mut command = program("fw");
    command.arg("lm3s6965evb").env("TMPDIR", temporary);
    command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    let mut fw = process::spawn(&mut command, LIMIT).unwrap_or_else(|error| panic!("{error}"));
    let mut log = BufReader::new(fw.child.stdout.take().expect("piped"));
    log.read_line(&mut String::new())
        .expect("the board says something");
    assert!(
        !left(temporary).is_empty(),
        "the board has its folder there"
    );
    kill(Pid::from_raw(fw.child.id().cast_signed()), signal).expect("it runs");
    fw.wait().expect("it ends").code()
}

fn left(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("it is there");
    entries
        .map(|entry| entry.expect("an entry").path())
        .collect()
}

#[test]
fn an_interrupted_command_leaves_no_temporary_folder() {
    let temporary = tempfile::tempdir().expect("there is room for it");
    assert_eq!(ended_by(Signal::SIGTERM, temporary.path()), Some(143));
    assert_eq!(left(temporary.path()), [""; 0].map(PathBuf::from));
}

#[test]
fn the_folder_of_a_killed_command_is_removed_by_the_next_command() {
    const LONG_AGO: Duration = Duration::from_secs(3600);
    let temporary = tempfile::tempdir().expect("there is room for it");
    assert_eq!(ended_by(Signal::SIGKILL, temporary.path()), None);
    let folders = left(temporary.path());
    let [folder] = &folders[..] else {
        panic!("{folders:?}")
    };

    let opened = fs::File::open(folder).expect("a folder");
    opened
        .set_modified(SystemTime::now() - LONG_AGO)
        .expect("its time");
    let mut next = program("fw");
    next.args(["lm3s6965evb", "--seconds", "1"])
        .env("TMPDIR", temporary.path());
    assert_eq!(output(&mut next).status.code(), Some(0));
    assert_eq!(left(temporary.path()), [""; 0].map(PathBuf::from));
}

#[test]
fn a_command_uses_the_project_that_it_is_run_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let copy = folder.path().join("fw");
    let checkout = folder.path().join("checkout");
    fs::copy(env!("CARGO_BIN_EXE_host-tests"), &copy).expect("a copy");

    for file in [
        "kernel/Cargo.toml",
        "firmware/Cargo.toml",
        "host-tests/Cargo.toml",
        "firmware/src/bin/elsewhere.rs",
    ] {
        let file = checkout.join(file);
        fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
        fs::write(file, "").expect("a file");
    }
    let help = |within: &Path| {
        output(
            Command::new(&copy)
                .args(["fw", "--help"])
                .current_dir(within)
                .env_remove("CARGO_MANIFEST_DIR"),
        )
    };
    let inside = help(&checkout.join("firmware/src"));
    assert!(
        inside.status.success() && inside.stdout.contains("Binaries:\n  elsewhere\n"),
        "{inside:?}"
    );
    let Output {
        status,
        stdout,
        stderr,
    } = help(folder.path());
    assert_eq!(
        (status.code(), &*stdout, stderr.lines().count()),
        (Some(2), "", 1),
        "{stderr}"
    );
}

fn flash(arguments: &[&str], path: impl IntoIterator<Item = PathBuf>) -> Output {
    output(program("flash-f4").args(arguments).env(
        "PATH",
        env::join_paths(path).expect("no colon in a folder's name"),
    ))
}

#[test]
fn without_probe_rs_the_error_names_it() -> io::Result<()> {
    let nothing = tempfile::tempdir()?;
    let output = flash(&[], [nothing.path().to_owned()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        output
            .stderr
            .starts_with("error: flashing needs probe-rs, which is not installed: cargo install ")
    );
    assert_eq!(output.stderr.lines().count(), 1);
    Ok(())
}

/// Runs the command with a fake program of this name, which prints its arguments and then executes
/// `ends`. Returns the last argument, a file.
fn handed(
    name: &str,
    arguments: &[&str],
    said: &str,
    ends: &str,
    code: i32,
) -> io::Result<PathBuf> {
    let folder = tempfile::tempdir()?;
    let fake = folder.path().join(name);
    fs::write(&fake, format!("#!/bin/sh\necho \"$@\"\n{ends}\n"))?;
    fs::set_permissions(&fake, Permissions::from_mode(0o755))?;
    let rest = env::var_os("PATH").unwrap_or_default();
    let output = flash(
        arguments,
        [folder.path().to_owned()]
            .into_iter()
            .chain(env::split_paths(&rest)),
    );
    assert!(
        output.stdout.starts_with(said) && output.status.code() == Some(code),
        "{output:?}"
    );
    let line = output.stdout.lines().next().unwrap_or_default();
    Ok(line.split_whitespace().last().unwrap_or_default().into())
}

#[test]
fn probe_rs_receives_the_image() -> io::Result<()> {
    let image = handed(
        "probe-rs",
        &["--chip", "STM32F407VGTx"],
        "run --chip STM32F407VGTx /",
        "exit 7",
        7,
    )?;
    assert!(
        image.ends_with("thumbv7em-none-eabihf/release/stm32f405"),
        "{}",
        image.display()
    );
    assert_eq!(fs::read(image)?.get(..4), Some(&b"\x7fELF"[..]));
    Ok(())
}

/// The exit code of `dfu-util` does not count. The file that it receives is a program that QEMU
/// runs.
#[test]
fn dfu_util_receives_the_bytes_of_the_flash() -> io::Result<()> {
    let bin = handed(
        "dfu-util",
        &["--dfu"],
        "-d 0483:df11 -a 0 -s 0x08000000 -D /",
        "echo 'File downloaded successfully'; exit 74",
        0,
    )?;
    let mut qemu = Command::new(toolchain::ready().expect("the tools").qemu);
    qemu.args([
        "-machine",
        STM32F405.machine,
        "-cpu",
        STM32F405.cpu,
        "-display",
        "none",
        "-kernel",
    ])
    .arg(bin);
    qemu.args(["-serial", "null", "-serial", "null", "-serial", "stdio"])
        .stdin(Stdio::null());
    let mut qemu =
        process::spawn(qemu.stdout(Stdio::piped()).stderr(Stdio::null()), LIMIT).expect("QEMU");
    let mut inbox = Inbox::default();
    let bytes = BufReader::new(qemu.child.stdout.take().expect("its serial port")).bytes();
    let mut frames = bytes
        .map_while(Result::ok)
        .filter_map(|byte| inbox.take(byte))
        .filter_map(ToHost::frame);
    assert_eq!(frames.next().map(|frame| frame.report.step), Some(1));
    Ok(())
}

#[test]
fn a_download_that_is_not_reported_as_complete_fails_with_any_exit_code() -> io::Result<()> {
    let said = "-d 0483:df11 -a 0 -s 0x08000000 -D /";
    handed("dfu-util", &["--dfu"], said, "exit 0", 1).map(drop)
}

/// The label on an RP2040's drive.
const LABEL: &str = "UF2 Bootloader v3.0\nModel: Raspberry Pi RP2\nBoard-ID: RPI-RP2\n";

fn pico(drive: &Path) -> Output {
    output(program("pico").arg("--drive").arg(drive))
}

/// The blocks are read as by the boot ROM.
#[test]
fn the_copied_file_has_the_program_as_in_flash() {
    let drive = tempfile::tempdir().expect("a folder");
    fs::write(drive.path().join("INFO_UF2.TXT"), LABEL).expect("a label");
    let output = pico(drive.path());
    assert_eq!(output.status.code(), Some(0), "{output:?}");
    let file = fs::read(drive.path().join("pico.uf2")).expect("it is copied");
    let (blocks, rest) = file.as_chunks::<512>();
    assert!(rest.is_empty());

    let elf = toolchain::ready()
        .expect("the tools")
        .build_for(&PICO)
        .expect("the firmware");
    let (start, image) = flash_image(&fs::read(elf).expect("a file")).expect("a program");
    let mut flashed = Vec::new();

    for (number, block) in blocks.iter().enumerate() {
        let words: Vec<_> = block
            .as_chunks()
            .0
            .iter()
            .map(|bytes| u32::from_le_bytes(*bytes))
            .collect();
        let place = start + 256 * number as u32;

        // The magic numbers, the flag of a family, the address, the size, the number of the block,
        // the number of blocks, and the family of the RP2040.
        let head = [
            0x0a32_4655,
            0x9e5d_5157,
            0x2000,
            place,
            256,
            number as u32,
            blocks.len() as u32,
            0xe48b_ff56,
        ];
        assert_eq!((&words[..8], words[127]), (&head[..], 0x0ab1_6f30));
        flashed.extend(&block[32..][..256]);
    }

    assert_eq!(flashed.len(), image.len().next_multiple_of(256));
    assert!(flashed.starts_with(&image));
}

#[test]
fn the_drive_of_another_board_is_refused() {
    let drive = tempfile::tempdir().expect("a folder");
    fs::write(
        drive.path().join("INFO_UF2.TXT"),
        LABEL.replace("RPI-RP2", "RP2350"),
    )
    .expect("a label");
    let output = pico(drive.path());
    assert_eq!(
        (output.status.code(), output.stdout.as_str()),
        (Some(2), "")
    );
    assert!(
        output.stderr.lines().count() == 1 && output.stderr.contains("Pico 2"),
        "{}",
        output.stderr
    );
}
