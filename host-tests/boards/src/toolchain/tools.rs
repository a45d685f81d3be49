//! The programs and libraries that the project needs. Each is found on the system, or else brought
//! without root: `rustup` adds the core libraries, and everything else is unpacked from Debian's
//! packages into the target folder.

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf, absolute};
use std::process::Command;
use std::time::Duration;
use std::{env, fs};

use super::run::{attempt, quick_output};
use super::{target, workspace};
use crate::console::cli::{Refused, complain};

pub(super) struct Program {
    /// The package has the first name; any will do on the system.
    names: &'static [&'static str],
    least: u32,
    folder: &'static str,
    packages: &'static [&'static str],
    programs: &'static [&'static str],
    /// What to install on a system without Debian's packages.
    install: &'static str,
}

/// The emulator of the boards. Its option `-action` needs version 6.0.
pub(super) const QEMU: Program = Program {
    names: &["qemu-system-arm"],
    least: 6,
    folder: "qemu",
    packages: &["qemu-system-arm"],
    programs: &["qemu-system-arm"],
    install: "qemu-system-arm (Homebrew: qemu), version 6 or newer",
};

pub(super) const QEMU_RISCV: Program = Program {
    names: &["qemu-riscv32"],
    ..QEMU_AARCH64
};

pub(super) const QEMU_AARCH64: Program = Program {
    names: &["qemu-aarch64"],
    least: 6,
    folder: "qemu-user",
    packages: &["qemu-user"],
    programs: &["qemu-riscv32", "qemu-aarch64"],
    install: "qemu-user, version 6 or newer",
};

/// The package rp2040js requires version 18.
pub(super) const NODE: Program = Program {
    names: &["node"],
    least: 18,
    folder: "node",
    packages: &["nodejs", "npm"],
    programs: &["node", "npm"],
    install: "nodejs and npm, version 18 of Node.js or newer",
};

const NPM: Program = Program {
    names: &["npm"],
    least: 1,
    ..NODE
};

pub(super) const CHROMIUM: Program = Program {
    names: &["chromium-headless-shell", "chromium", "google-chrome"],
    least: 1,
    folder: "chromium",
    packages: &["chromium-headless-shell", "chromium-common"],
    programs: &["chromium-headless-shell"],
    install: "chromium",
};

impl Program {
    /// An unpacked program has priority: the system's was not usable when it was unpacked.
    fn find(&self) -> Result<PathBuf, String> {
        let name = self.names[0];
        let unpacked = executable(target().join(self.folder).join(name));
        let of_system = self.names.iter().filter_map(|name| find(name));
        let mut why = format!("there is no {name} on PATH");
        for path in unpacked.into_iter().chain(of_system) {
            let shown = path.display();
            match major_version(&path) {
                Ok(version) if version >= self.least => return Ok(path),
                Ok(version) => {
                    why = format!("{shown} has version {version}, older than {}", self.least);
                }
                Err(reason) => why = format!("{shown} does not work ({reason})"),
            }
        }
        Err(why)
    }

    pub(super) fn ready(&self) -> Result<PathBuf, Refused> {
        self.find()
            .map_err(|why| self.missing(&why, "run cargo setup, or "))
    }

    pub(super) fn set_up(&self) -> Result<PathBuf, Refused> {
        let Err(why) = self.find() else {
            return self.ready();
        };
        self.unpack()
            .and_then(|()| self.find())
            .map_err(|failure| self.missing(&format!("{why}; {failure}"), ""))
    }

    fn missing(&self, why: &str, remedy: &str) -> Refused {
        let Self { names, install, .. } = self;
        Refused::because(format_args!(
            "{} is missing: {why}; {remedy}install this system's package {install}",
            names[0]
        ))
    }

    fn unpack(&self) -> Result<(), String> {
        const SCRIPT: &str = "host-tests/boards/src/toolchain/unpack.sh";
        const LIMIT: Duration = Duration::from_secs(1200);

        if find("apt-get").is_none() {
            return Err("there is no apt-get to unpack Debian's".to_owned());
        }
        let folder = target().join(self.folder);
        let packages = self.packages.join(", ");
        let mut command = Command::new("sh");
        command
            .arg(workspace().join(SCRIPT))
            .arg(&folder)
            .args([self.programs.join(" "), self.packages.join(" ")])
            .env("LC_ALL", "C");
        let into = folder.strip_prefix(workspace()).unwrap_or(&folder);
        let doing = format!("unpacking {packages} into {}", into.display());
        attempt(&mut command, LIMIT, &doing)?;
        complain(format_args!("unpacked {packages} into {}", into.display()));
        Ok(())
    }
}

fn major_version(path: &Path) -> Result<u32, String> {
    let output = quick_output(Command::new(path).arg("--version"))?;
    let number = |word: &str| {
        let digits = word.trim_start_matches('v').split('.').next()?;
        digits.parse().ok()
    };
    output
        .split_whitespace()
        .find_map(number)
        .ok_or_else(|| "it prints no version".to_owned())
}

/// Returns an absolute path, because programs run in other folders.
pub fn find(program: &str) -> Option<PathBuf> {
    env::split_paths(&env::var_os("PATH")?)
        .find_map(|folder| executable(absolute(folder.join(program)).ok()?))
}

fn executable(path: PathBuf) -> Option<PathBuf> {
    fs::metadata(&path)
        .is_ok_and(|file| file.is_file() && file.permissions().mode() & 0o111 != 0)
        .then_some(path)
}

fn find_core(targets: &[&str]) -> Result<(), String> {
    let mut rustc = Command::new("rustc");
    rustc.args(["--print", "sysroot"]).current_dir(workspace());
    // rustup would install a missing toolchain, also where nothing may be installed.
    let sysroot = quick_output(rustc.env("RUSTUP_AUTO_INSTALL", "0"))?;
    let libraries = Path::new(sysroot.trim()).join("lib/rustlib");
    let has_core = |target: &&&str| {
        let files = fs::read_dir(libraries.join(target).join("lib"));
        let mut files = files.into_iter().flatten().flatten();
        files.any(|file| file.file_name().as_encoded_bytes().starts_with(b"libcore-"))
    };
    match targets.iter().find(|target| !has_core(target)) {
        Some(target) => Err(format!("rustc has none for {target}")),
        None => Ok(()),
    }
}

pub(super) fn core(installs: bool, targets: &[&str]) -> Result<(), Refused> {
    const LIMIT: Duration = Duration::from_secs(60);

    let all = targets.join(" ");
    let missing = |why: String| {
        Refused::because(format_args!(
            "Rust's core library is missing: {why}; run rustup target add {all}"
        ))
    };
    let found = find_core(targets);
    if found.is_ok() || !installs {
        return found.map_err(missing);
    }
    if find("rustup").is_none() {
        return Err(missing("there is no rustup (https://rustup.rs)".to_owned()));
    }
    let mut rustup = Command::new("rustup");
    rustup
        .args(["target", "add"])
        .args(targets)
        .current_dir(workspace())
        .env("RUSTUP_AUTO_INSTALL", "0");
    attempt(&mut rustup, LIMIT, "rustup fetches Rust's core library")
        .and_then(|()| find_core(targets))
        .map_err(missing)
}

const IS_FETCHED: &str = "const [{ dependencies }, { version }] = ['.', './node_modules/rp2040js']
    .map((folder) => require(folder + '/package.json'));
    if (version !== dependencies.rp2040js) throw 'another version'";

pub(super) fn rp2040js(installs: bool, node: &Path) -> Result<(), Refused> {
    const LIMIT: Duration = Duration::from_secs(120);

    let folder = workspace().join("host-tests/boards/rp2040");
    let mut check = Command::new(node);
    check.args(["--eval", IS_FETCHED]).current_dir(&folder);
    if quick_output(&mut check).is_ok() {
        return Ok(());
    }
    let missing = |why: &str| {
        Refused::because(format_args!(
            "the emulator of the Raspberry Pi Pico is missing: {why}; run npm ci --prefix \
             host-tests/boards/rp2040"
        ))
    };
    if !installs {
        return Err(missing("npm has not fetched it"));
    }
    // npm fetches exactly the versions of the lock file, without running their scripts.
    let mut npm = Command::new(NPM.set_up()?);
    npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"])
        .current_dir(&folder);
    attempt(&mut npm, LIMIT, "npm fetches rp2040js").map_err(|why| missing(&why))
}
