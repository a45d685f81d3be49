//! What is there already. Runs nothing that changes anything.

use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use super::error::{CORE_PACKAGES, MANAGERS, Manager, Part, QEMU_PACKAGE, SetupError};
use super::system::System;
use super::{ArmCore, Qemu, TARGETS, Toolchain, target, workspace};

/// For a program that only says its version.
const QUICK: Duration = Duration::from_secs(20);
/// Debian's compiler, whatever the PATH says.
pub(super) const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
/// Debian's cargo, whatever the PATH says.
pub(super) const DEBIAN_CARGO: &str = "/usr/bin/cargo";

/// All the tools, or which of them are missing and why.
pub(super) fn toolchain(system: &impl System) -> Result<Toolchain, SetupError> {
    match (arm_core(system), qemu(system)) {
        (Ok(core), Ok(qemu)) => Ok(Toolchain { core, qemu }),
        (core, qemu) => {
            let mut missing = Vec::new();
            let mut reasons = Vec::new();
            if let Err(reason) = core {
                missing.push(Part::ArmCore);
                reasons.push(reason);
            }
            if let Err(trouble) = qemu {
                missing.push(Part::Qemu);
                reasons.push(trouble.to_string());
            }
            Err(SetupError { missing, reason: reasons.join("; "), manager: manager(system), tried: true })
        }
    }
}

/// The system's package manager.
pub(super) fn manager(system: &impl System) -> Option<Manager> {
    MANAGERS.into_iter().find(|manager| system.find(manager.program).is_some())
}

/// The core library: ready-made beside the compiler in use, else Debian's sources.
pub(super) fn arm_core(system: &impl System) -> Result<ArmCore, String> {
    let compiler = compiler(system)?;
    let has_core = |target: &str| {
        let library = compiler.libraries().join(target).join("lib");
        system.list(&library).iter().any(|name| name.starts_with("libcore-"))
    };
    if TARGETS.iter().all(|target| has_core(target)) {
        return Ok(ArmCore::ReadyMade);
    }
    let version = debian_rustc(system)?;
    Ok(ArmCore::FromSource { version, linker: compiler.linker(system)? })
}

/// The folder of `rust-lld`, which Debian's packages do not have.
pub(super) fn linker(system: &impl System) -> Result<PathBuf, String> {
    compiler(system)?.linker(system)
}

/// Debian's compiler, if it comes with all that builds the core library and is not too old for this workspace.
/// A package that dpkg had to leave half-installed does not count.
fn debian_rustc(system: &impl System) -> Result<String, String> {
    let absent = |_| "neither rustup nor Debian has brought one".to_owned();
    let mut query = Command::new("dpkg-query");
    query.args(["--show", "--showformat=${db:Status-Status}\\n"]).args(CORE_PACKAGES);
    let states = output(system, &mut query).map_err(absent)?;
    if states.lines().any(|state| state != "installed") {
        return Err(format!("dpkg has not finished installing {}", CORE_PACKAGES.join(", ")));
    }
    says(system, Command::new(DEBIAN_CARGO).arg("--version")).map_err(absent)?;
    let version = says(system, Command::new(DEBIAN_RUSTC).arg("--version")).map_err(absent)?;
    let number = version.split(' ').nth(1).unwrap_or_default();
    let least = env!("CARGO_PKG_RUST_VERSION");
    if minor_version(number) < minor_version(least) {
        return Err(format!("Debian's {version:?} is older than {least}"));
    }
    Ok(format!("rustc {number}"))
}

/// 88 of `1.88.0`.
fn minor_version(version: &str) -> Option<u32> {
    version.split('.').nth(1)?.parse().ok()
}

/// Why there is no emulator.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum QemuTrouble {
    #[error("there is no such program")]
    Absent,
    #[error("{} does not run: {reason}", path.display())]
    Broken { path: PathBuf, reason: String },
}

/// Where the set-up unpacks an emulator for this project alone.
pub(super) fn own_qemu_folder() -> PathBuf {
    target().join("qemu")
}

/// The emulator, if it runs: the system's, else this project's own.
pub(super) fn qemu(system: &impl System) -> Result<Qemu, QemuTrouble> {
    let folder = own_qemu_folder();
    let own = || system.list(&folder).iter().any(|name| name == QEMU_PACKAGE).then(|| folder.join(QEMU_PACKAGE));
    let path = system.find(QEMU_PACKAGE).or_else(own).ok_or(QemuTrouble::Absent)?;
    match says(system, Command::new(&path).arg("--version")) {
        Ok(version) => {
            let version = version.strip_prefix("QEMU emulator version ").unwrap_or(&version).to_owned();
            Ok(Qemu { path, version })
        }
        Err(reason) => Err(QemuTrouble::Broken { path, reason }),
    }
}

/// The compiler that builds for the host: where its libraries are, and the name of the host.
struct Compiler {
    sysroot: PathBuf,
    host: String,
}

fn compiler(system: &impl System) -> Result<Compiler, String> {
    let mut command = Command::new("rustc");
    command.args(["--print", "sysroot", "--print", "host-tuple"]).current_dir(workspace());
    let output = output(system, command.env("RUSTUP_AUTO_INSTALL", "0"))?;
    match output.lines().collect::<Vec<_>>()[..] {
        [sysroot, host, ..] => Ok(Compiler { sysroot: sysroot.into(), host: host.to_owned() }),
        _ => Err(format!("rustc does not say where its libraries are, but {output:?}")),
    }
}

impl Compiler {
    fn libraries(&self) -> PathBuf {
        self.sysroot.join("lib/rustlib")
    }

    fn linker(&self, system: &impl System) -> Result<PathBuf, String> {
        let folder = self.libraries().join(&self.host).join("bin");
        if system.list(&folder).iter().any(|name| name == "rust-lld") {
            return Ok(folder);
        }
        Err(format!("there is no rust-lld in {}; the compiler of rustup.rs has one", folder.display()))
    }
}

/// The first line of what a quick command says.
pub(super) fn says(system: &impl System, command: &mut Command) -> Result<String, String> {
    Ok(output(system, command)?.lines().next().unwrap_or_default().to_owned())
}

fn output(system: &impl System, command: &mut Command) -> Result<String, String> {
    let output = system.run(command, QUICK, None).map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(output.stdout);
    }
    Err(output.stderr.lines().next().unwrap_or("it fails without a word").to_owned())
}
