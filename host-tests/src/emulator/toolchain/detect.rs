//! What is there already. Runs nothing that changes anything.

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use std::{env, fs, io};

use super::{ArmCore, target, workspace};
use crate::emulator::process::{Output, run};

/// For a program that only says its version.
const QUICK: Duration = Duration::from_secs(20);
/// Debian's compiler, by its own path.
pub(super) const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
pub(super) const DEBIAN_CARGO: &str = "/usr/bin/cargo";
/// The Debian packages that build the ARM core library.
pub(super) const CORE_PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];

/// An emulator of QEMU's.
pub(super) struct Emulator {
    pub program: &'static str,
    pub package: &'static str,
    /// Where the set-up unpacks it for this project alone, in the target folder.
    folder: &'static str,
}

pub(super) const QEMU: Emulator = Emulator { program: "qemu-system-arm", package: "qemu-system-arm", folder: "qemu" };
pub(super) const QEMU_RISCV: Emulator = Emulator { program: "qemu-riscv32", package: "qemu-user", folder: "qemu-user" };

/// The core library for these targets: ready-made beside the compiler in use, else Debian's sources.
pub(super) fn core(targets: &[&str]) -> Result<ArmCore, String> {
    let (in_use, _) = libraries("rustc")?;
    let has_core = |target: &&str| {
        let mut files = fs::read_dir(in_use.join(target).join("lib")).into_iter().flatten().flatten();
        files.any(|file| file.file_name().as_encoded_bytes().starts_with(b"libcore-"))
    };
    if targets.iter().all(has_core) {
        return Ok(ArmCore::ReadyMade);
    }
    let (debians, _) = libraries(DEBIAN_RUSTC).map_err(|_| "neither rustup nor Debian has brought one")?;
    if !debians.join("src/rust/library/core").is_dir() || !Path::new(DEBIAN_CARGO).is_file() {
        return Err(format!("of Debian's {} not all are installed", CORE_PACKAGES.join(", ")));
    }
    let version = says(Command::new(DEBIAN_RUSTC).arg("--version"))?;
    let least = env!("CARGO_PKG_RUST_VERSION");
    if number(&version, 1) < number(least, 1) {
        return Err(format!("Debian's {} is older than {least}", version.trim()));
    }
    Ok(ArmCore::FromSource { linker: linker()? })
}

/// A number in a version; part 0 is the first.
pub(super) fn number(version: &str, part: usize) -> Option<u32> {
    version.split('.').nth(part)?.trim_matches(|c: char| !c.is_ascii_digit()).parse().ok()
}

/// The folder of `rust-lld`, which Debian's packages do not have.
pub(super) fn linker() -> Result<PathBuf, String> {
    let (libraries, host) = libraries("rustc")?;
    let folder = libraries.join(host).join("bin");
    if folder.join("rust-lld").is_file() {
        return Ok(folder);
    }
    Err(format!("there is no rust-lld in {}; the compiler of rustup.rs has one", folder.display()))
}

/// Where a compiler has its libraries, and its name of the host.
fn libraries(rustc: &str) -> Result<(PathBuf, String), String> {
    let mut command = Command::new(rustc);
    command.args(["--print", "sysroot", "--print", "host-tuple"]).current_dir(workspace());
    let said = says(command.env("RUSTUP_AUTO_INSTALL", "0"))?;
    let (sysroot, host) = said.split_once('\n').ok_or("rustc does not say where its libraries are")?;
    Ok((Path::new(sysroot).join("lib/rustlib"), host.trim().to_owned()))
}

impl Emulator {
    pub fn own_folder(&self) -> PathBuf {
        target().join(self.folder)
    }

    /// The first that runs: the system's, else this project's own.
    pub fn find(&self) -> Result<PathBuf, String> {
        let mut why = "there is no such program".to_owned();
        for path in find(self.program).into_iter().chain(executable(self.own_folder().join(self.program))) {
            match says(Command::new(&path).arg("--version")) {
                Ok(_) => return Ok(path),
                Err(reason) => why = reason,
            }
        }
        Err(why)
    }
}

/// The program that would be run by this name.
pub(super) fn find(program: &str) -> Option<PathBuf> {
    env::split_paths(&env::var_os("PATH")?).find_map(|folder| executable(folder.join(program)))
}

fn executable(path: PathBuf) -> Option<PathBuf> {
    fs::metadata(&path).is_ok_and(|file| file.is_file() && file.permissions().mode() & 0o111 != 0).then_some(path)
}

/// What a quick command says, or why it fails.
pub(super) fn says(command: &mut Command) -> Result<String, String> {
    let ran = run(command, QUICK);
    said(command, ran)
}

/// What a command has said, or why it failed: the line in which it says so.
pub(super) fn said(command: &Command, ran: io::Result<Output>) -> Result<String, String> {
    let output = ran.map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(output.stdout);
    }
    let full = |line: &&str| line.contains("No space left on device");
    let marked = |line: &&str| ["E: ", "error: ", "npm "].iter().any(|mark| line.starts_with(mark));
    let lines = || output.stderr.lines();
    let line = lines().find(full).or_else(|| lines().find(marked)).or_else(|| lines().last());
    let line: String = line.unwrap_or("it fails without a word").chars().take(200).collect();
    Err(format!("{}: {line}", command.get_program().to_string_lossy()))
}
