//! Bringing what is missing.

use std::fs::{self, File};
use std::io;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use nix::fcntl::{Flock, FlockArg};

use super::detect::{self, CORE_PACKAGES, Emulator, find, said};
use super::{ArmCore, target, workspace};
use crate::console::cli::{Refused, complain};
use crate::console::progress::Progress;
use crate::emulator::process::{Output, run_watched};

/// For `rustup target add`: 40 MB. Where it can only hang, this is what that costs, once.
const RUSTUP: Duration = Duration::from_secs(60);
/// For fetching and unpacking at most 400 MB, and for a turn at dpkg.
const INSTALL: Duration = Duration::from_secs(1200);
const UNPACK_QEMU: &str = "host-tests/src/emulator/toolchain/unpack-qemu.sh";

/// Waits for our turn at a set-up; it ends when this is dropped or the process ends, however it ends.
pub(super) fn turn() -> Result<Flock<File>, Refused> {
    let path = target().join("setup.lock");
    let refuse = |error: io::Error| Refused::because(format_args!("cannot lock {}: {error}", path.display()));
    fs::create_dir_all(target()).map_err(refuse)?;
    let file = File::options().create(true).truncate(false).write(true).open(&path).map_err(refuse)?;
    Flock::lock(file, FlockArg::LockExclusive).map_err(|(_, error)| refuse(error.into()))
}

/// A way to install something: what to say when it worked, and the function that does it. It must be found afterwards, too.
type Way<'a> = (String, &'a dyn Fn() -> Result<(), String>);

/// What `find` finds, else what the first of the `ways` brings that does; or why each fails.
pub(super) fn bring<T>(find: impl Fn() -> Result<T, String>, ways: &[Way]) -> Result<T, String> {
    let mut failures = Vec::new();
    if let Ok(found) = find() {
        return Ok(found);
    }
    for (done, way) in ways {
        match way().and_then(|()| find()) {
            Ok(found) => {
                let because = failures.iter().map(|failure| format!(", because {failure}"));
                complain(format_args!("done: {done}{}", because.collect::<String>()));
                return Ok(found);
            }
            Err(failure) => failures.push(failure),
        }
    }
    Err(failures.join("; "))
}

/// The core library: ready-made by rustup, else Debian's sources and their compiler.
pub(super) fn core(targets: &[&str]) -> Result<ArmCore, String> {
    let rustup = || {
        let mut rustup = Command::new("rustup");
        rustup.args(["target", "add"]).args(targets).current_dir(workspace()).env("RUSTUP_AUTO_INSTALL", "0");
        let doing = format!("rustup fetches the core library, for at most {} s", RUSTUP.as_secs());
        attempt(&mut rustup, RUSTUP, &doing)
    };
    let debian = || detect::linker().and_then(|_| install_packages(&CORE_PACKAGES));
    let ways: [Way; 2] = [
        (format!("rustup added {}", targets.join(", ")), &rustup),
        (format!("apt-get installed {}", CORE_PACKAGES.join(", ")), &debian),
    ];
    bring(|| detect::core(targets), &ways)
}

/// An emulator from Debian's packages, installed, or unpacked for this project alone where they cannot be: where that would cost the
/// user another package, or another may do it.
pub(super) fn qemu(emulator: &Emulator) -> Result<PathBuf, String> {
    let (Emulator { program, package, .. }, folder) = (emulator, emulator.own_folder());
    let unpack = || {
        let mut unpack = Command::new("sh");
        unpack.arg(workspace().join(UNPACK_QEMU)).arg(&folder).args([package, program]).env("LC_ALL", "C");
        attempt(&mut unpack, INSTALL, "unpacking QEMU, which cannot be installed")
    };
    let ways: [Way; 2] = [
        (format!("apt-get installed {package}"), &|| install_packages(&[package])),
        (format!("{package} unpacked into {}", folder.display()), &unpack),
    ];
    bring(|| emulator.find(), &ways)
}

/// Installs packages of Debian's, by its newest lists: old ones may name packages that are gone.
pub(super) fn install_packages(packages: &[&str]) -> Result<(), String> {
    if find("apt-get").is_none() {
        return Err("this system has no apt-get, the only package manager this command runs".to_owned());
    }
    if !nix::unistd::geteuid().is_root() {
        return Err("only root may install packages".to_owned());
    }
    let updated = attempt(&mut apt_get("update"), INSTALL, "apt-get fetches the lists of packages");
    let mut install = apt_get("install");
    install.args(["--no-install-recommends", "--no-remove", "--reinstall"]).args(packages);
    // One bad source of many does not stop the install; where it fails too, the lists are the cause.
    attempt(&mut install, INSTALL, &format!("apt-get installs {}", packages.join(", ")))
        .map_err(|failure| updated.err().unwrap_or(failure))
}

/// `apt-get` that asks nothing, waits its turn and does not wait for a dead network.
fn apt_get(action: &str) -> Command {
    let mut command = Command::new("apt-get");
    command.args([action, "--yes", "--quiet"]);
    for option in ["DPkg::Lock::Timeout=120", "Dpkg::Use-Pty=0", "Acquire::http::Timeout=30", "Acquire::Retries=1"] {
        command.args(["-o", option]);
    }
    command.env("DEBIAN_FRONTEND", "noninteractive").env("LC_ALL", "C");
    command
}

/// Runs a command to its end; if it fails, the line in which it says why.
pub(super) fn attempt(command: &mut Command, limit: Duration, doing: &str) -> Result<(), String> {
    let ran = run_shown(command, limit, doing);
    said(command, ran).map(drop)
}

/// Runs a command to its end, within the limit, and shows meanwhile what is being done.
pub(super) fn run_shown(command: &mut Command, limit: Duration, doing: &str) -> io::Result<Output> {
    let progress = Progress::start(doing);
    run_watched(command, limit, |line| progress.alive(line))
}
