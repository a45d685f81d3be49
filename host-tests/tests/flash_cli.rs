//! `cargo flash-f4` with a stand-in for `probe-rs`, and without any.

use std::env;
use std::fs::{self, Permissions};
use std::io;
use std::os::unix::fs::PermissionsExt;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use host_tests::emulator::process::{self, Output};

/// For a build of the firmware from nothing.
const LIMIT: Duration = Duration::from_secs(1800);

fn flash(arguments: &[&str], path: impl IntoIterator<Item = PathBuf>) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_flash-f4"));
    command.args(arguments).env("PATH", env::join_paths(path).expect("no colon in a folder's name"));
    process::run(&mut command, LIMIT).unwrap_or_else(|error| panic!("{error}"))
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

#[test]
fn it_hands_the_image_to_probe_rs() -> io::Result<()> {
    let folder = tempfile::tempdir()?;
    let stand_in = folder.path().join("probe-rs");
    fs::write(&stand_in, "#!/bin/sh\necho \"$@\"\nexit 7\n")?;
    fs::set_permissions(&stand_in, Permissions::from_mode(0o755))?;
    let rest = env::var_os("PATH").unwrap_or_default();
    let path = || [folder.path().to_owned()].into_iter().chain(env::split_paths(&rest));
    let output = flash(&["--chip", "STM32F407VGTx"], path());
    assert!(output.stdout.starts_with("run --chip STM32F407VGTx /"), "{output:?}");
    let image = output.stdout.split_whitespace().last().unwrap_or_default();
    assert!(image.ends_with("thumbv7em-none-eabihf/release/stm32f405"), "{image}");
    assert_eq!(fs::read(image)?.get(..4), Some(&b"\x7fELF"[..]));
    assert_eq!(output.status.code(), Some(7), "its exit code is the command's");
    Ok(())
}
