//! Bringing what is missing. The order keeps failure early: what is known to be impossible is said before anything is
//! changed, and everything from Debian comes in one go.

use std::process::Command;
use std::time::Duration;

use super::detect::{self, QemuTrouble};
use super::error::{CORE_PACKAGES, MANAGERS, Part, QEMU_PACKAGE, SetupError};
use super::system::System;
use super::{TARGETS, Toolchain, workspace};

/// For `rustup target add`: 40 MB. Where it can only hang, this is what that costs, once.
const RUSTUP: Duration = Duration::from_secs(60);
/// For fetching Debian's lists.
const UPDATE: Duration = Duration::from_secs(300);
/// For fetching and unpacking at most 400 MB, and for a turn at dpkg.
const INSTALL: Duration = Duration::from_secs(1200);
/// What apt-get says instead of removing a package.
const WOULD_REMOVE: &str = "Packages need to be removed";
/// What rustup, dpkg and the unpacking say where the disk is full, and what apt-get says beforehand if it can tell.
const DISK_IS_FULL: [&str; 2] = ["No space left on device", "enough free space"];
/// Unpacks QEMU's packages, in the workspace.
const UNPACK_QEMU: &str = "host-tests/src/emulator/toolchain/unpack-qemu.sh";
/// How much of a failed command's own words is passed on, in characters.
const LONGEST_REASON: usize = 120;

/// Brings what is missing; a line for each thing that was done.
pub(super) fn set_up(system: &impl System) -> Result<(Toolchain, Vec<String>), SetupError> {
    let core_is_missing = detect::arm_core(system).is_err();
    let qemu_trouble = detect::qemu(system).err();
    let mut missing = Vec::new();
    missing.extend(core_is_missing.then_some(Part::ArmCore));
    missing.extend(qemu_trouble.is_some().then_some(Part::Qemu));
    let refuse = |missing: &[Part], reason: String| {
        Err(SetupError { missing: missing.to_vec(), reason, manager: detect::manager(system), tried: true })
    };

    let packages_allowed = debian_allows(system);
    if let (Some(_), Err(reason)) = (&qemu_trouble, &packages_allowed) {
        return refuse(&missing, reason.clone());
    }

    let mut done = Vec::new();
    let mut packages = Vec::new();
    let mut rustup_failure = None;
    if core_is_missing {
        match add_targets(system) {
            Ok(()) => done.push(format!("rustup added {}", TARGETS.join(", "))),
            Err(failure) => {
                if let Err(reason) = packages_allowed.and_then(|()| detect::linker(system).map(|_| ())) {
                    return refuse(&missing, format!("{failure}; {reason}"));
                }
                packages.extend(CORE_PACKAGES);
                rustup_failure = Some(failure);
            }
        }
    }
    if qemu_trouble.is_some() {
        packages.push(QEMU_PACKAGE);
    }
    if !packages.is_empty() {
        let reinstall = matches!(qemu_trouble, Some(QemuTrouble::Broken { .. }));
        match bring_packages(system, &packages, reinstall) {
            Ok(lines) => done.extend(lines),
            Err(failure) => {
                let reason = rustup_failure.into_iter().chain([failure]).collect::<Vec<_>>().join("; ");
                return refuse(&missing_now(system), reason);
            }
        }
        done.extend(rustup_failure.map(|failure| format!("because {failure}")));
    }
    Ok((detect::toolchain(system)?, done))
}

fn missing_now(system: &impl System) -> Vec<Part> {
    detect::toolchain(system).err().map_or_else(Vec::new, |error| error.missing)
}

/// Whether Debian's packages can be installed here, else why not.
pub(super) fn debian_allows(system: &impl System) -> Result<(), String> {
    if system.find(MANAGERS[0].program).is_none() {
        return Err("this system has no apt-get, the only package manager this command runs".to_owned());
    }
    if !system.is_root() {
        return Err("only root may install packages".to_owned());
    }
    Ok(())
}

/// The ready-made core library. Success of rustup is not enough: it may skip a target it cannot have.
fn add_targets(system: &impl System) -> Result<(), String> {
    if system.find("rustup").is_none() {
        return Err("there is no rustup".to_owned());
    }
    let mut command = Command::new("rustup");
    command.args(["target", "add"]).args(TARGETS).current_dir(workspace()).env("RUSTUP_AUTO_INSTALL", "0");
    let doing = format!("rustup fetches the ARM core library, for at most {} s", RUSTUP.as_secs());
    attempt(system, &mut command, RUSTUP, &doing)?;
    match detect::arm_core(system) {
        Ok(_) => Ok(()),
        Err(_) => Err("rustup has no core library for these targets".to_owned()),
    }
}

/// Installs the packages; where QEMU's would cost the user another package, it is unpacked for this project alone.
fn bring_packages(system: &impl System, packages: &[&str], reinstall: bool) -> Result<Vec<String>, String> {
    let installed = |packages: &[&str]| format!("apt-get installed {}", packages.join(", "));
    match install_packages(system, packages, reinstall) {
        Ok(()) => Ok(vec![installed(packages)]),
        Err(failure) if failure.contains(WOULD_REMOVE) && packages.contains(&QEMU_PACKAGE) => {
            let others: Vec<_> = packages.iter().copied().filter(|&package| package != QEMU_PACKAGE).collect();
            let mut done = Vec::new();
            if !others.is_empty() {
                install_packages(system, &others, false)?;
                done.push(installed(&others));
            }
            let mut unpack = Command::new("sh");
            unpack.arg(workspace().join(UNPACK_QEMU)).arg(detect::own_qemu_folder()).env("LC_ALL", "C");
            attempt(system, &mut unpack, INSTALL, "installing QEMU would remove a package; it is unpacked instead")?;
            done.push(format!("{QEMU_PACKAGE} unpacked into {}", detect::own_qemu_folder().display()));
            Ok(done)
        }
        Err(failure) => Err(failure),
    }
}

/// Installs the newest that Debian has: old lists may name packages that are gone, or a compiler that is too old.
pub(super) fn install_packages(system: &impl System, packages: &[&str], reinstall: bool) -> Result<(), String> {
    let mut update = apt_get("update");
    update.args(["-o", "APT::Update::Error-Mode=any"]);
    let updated = attempt(system, &mut update, UPDATE, "apt-get fetches the lists of packages");
    let mut install = apt_get("install");
    install.args(["--no-install-recommends", "--no-remove"]).args(reinstall.then_some("--reinstall")).args(packages);
    let installed = attempt(system, &mut install, INSTALL, &format!("apt-get installs {}", packages.join(", ")));
    // One bad source of many does not stop the install; if that fails too, the earlier failure is the cause, except for
    // one that no list would change.
    installed.map_err(|failure| match updated {
        Err(earlier) if !failure.contains(WOULD_REMOVE) => earlier,
        _ => failure,
    })
}

/// `apt-get` that asks nothing, waits its turn and does not wait for a dead network.
fn apt_get(action: &str) -> Command {
    let mut command = Command::new(MANAGERS[0].program);
    command.args([action, "--yes", "--quiet"]);
    for option in ["DPkg::Lock::Timeout=120", "Dpkg::Use-Pty=0", "Acquire::http::Timeout=30", "Acquire::Retries=1"] {
        command.args(["-o", option]);
    }
    command.env("DEBIAN_FRONTEND", "noninteractive").env("LC_ALL", "C");
    command
}

/// Runs a command to its end; if it fails, the line in which it says why.
pub(super) fn attempt(system: &impl System, command: &mut Command, limit: Duration, doing: &str) -> Result<(), String> {
    let output = system.run(command, limit, Some(doing)).map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    let said = |start: &str| output.stderr.lines().find(|line| line.starts_with(start));
    // dpkg says it in the middle of a line, and apt-get sums up that dpkg has failed.
    let full = DISK_IS_FULL.iter().any(|words| output.stderr.contains(words)).then_some("the disk is full");
    let why = full.or_else(|| said("E: ")).or_else(|| said("error: ")).or_else(|| output.stderr.lines().last());
    let why = why.unwrap_or("it fails without a word").trim_start_matches("E: ").trim_start_matches("error: ");
    let why: String = why.chars().take(LONGEST_REASON).collect();
    Err(format!("{}: {why}", command.get_program().to_string_lossy()))
}
