//! The tools: where each is found, and the ways to bring it.

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;
use std::{env, fs};

use super::bring::{INSTALL, Way, attempt, bring, install_packages, says};
use super::{missing, target, workspace};
use crate::console::cli::Refused;

/// Debian's compiler, by its own path.
pub(super) const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
pub(super) const DEBIAN_CARGO: &str = "/usr/bin/cargo";
/// The Debian packages that build the ARM core library.
pub(super) const CORE_PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
/// For `rustup target add`: 40 MB. Where it can only hang, this is what that costs, once.
const RUSTUP: Duration = Duration::from_secs(60);
const UNPACK_QEMU: &str = "host-tests/src/emulator/toolchain/unpack-qemu.sh";

/// An emulator of QEMU's.
pub(super) struct Emulator {
    pub program: &'static str,
    pub package: &'static str,
    /// Where the set-up unpacks it for this project alone, in the target folder.
    folder: &'static str,
}

pub(super) const QEMU: Emulator = Emulator {
    program: "qemu-system-arm",
    package: "qemu-system-arm",
    folder: "qemu",
};
pub(super) const QEMU_RISCV: Emulator = Emulator {
    program: "qemu-riscv32",
    package: "qemu-user",
    folder: "qemu-user",
};

/// The core library for these targets: ready-made by rustup beside the compiler in use, else Debian's sources and their compiler,
/// with a linker.
pub(super) fn core(installs: bool, targets: &[&str]) -> Result<Option<PathBuf>, String> {
    let rustup = || {
        let mut rustup = Command::new("rustup");
        rustup
            .args(["target", "add"])
            .args(targets)
            .current_dir(workspace())
            .env("RUSTUP_AUTO_INSTALL", "0");
        let doing = format!(
            "rustup fetches the core library, for at most {} s",
            RUSTUP.as_secs()
        );
        attempt(&mut rustup, RUSTUP, &doing)
    };
    let debian = || linker().and_then(|_| install_packages(&CORE_PACKAGES));
    let ways: [Way; 2] = [
        (format!("rustup added {}", targets.join(", ")), &rustup),
        (
            format!("apt-get installed {}", CORE_PACKAGES.join(", ")),
            &debian,
        ),
    ];
    bring(installs, || find_core(targets), &ways)
}

fn find_core(targets: &[&str]) -> Result<Option<PathBuf>, String> {
    let (in_use, _) = libraries("rustc")?;
    let has_core = |target: &&str| {
        let mut files = fs::read_dir(in_use.join(target).join("lib"))
            .into_iter()
            .flatten()
            .flatten();
        files.any(|file| file.file_name().as_encoded_bytes().starts_with(b"libcore-"))
    };
    if targets.iter().all(has_core) {
        return Ok(None);
    }
    let (debians, _) =
        libraries(DEBIAN_RUSTC).map_err(|_| "neither rustup nor Debian has brought one")?;
    if !debians.join("src/rust/library/core").is_dir() || !Path::new(DEBIAN_CARGO).is_file() {
        return Err(format!(
            "of Debian's {} not all are installed",
            CORE_PACKAGES.join(", ")
        ));
    }
    let version = says(Command::new(DEBIAN_RUSTC).arg("--version"))?;
    let least = env!("CARGO_PKG_RUST_VERSION");
    if number(&version, 1) < number(least, 1) {
        return Err(format!("Debian's {} is older than {least}", version.trim()));
    }
    linker().map(Some)
}

/// The folder of `rust-lld`, which Debian's packages do not have.
fn linker() -> Result<PathBuf, String> {
    let (libraries, host) = libraries("rustc")?;
    let folder = libraries.join(host).join("bin");
    if folder.join("rust-lld").is_file() {
        return Ok(folder);
    }
    Err(format!(
        "there is no rust-lld in {}; the compiler of rustup.rs has one",
        folder.display()
    ))
}

/// Where a compiler has its libraries, and its name of the host.
fn libraries(rustc: &str) -> Result<(PathBuf, String), String> {
    let mut command = Command::new(rustc);
    command
        .args(["--print", "sysroot", "--print", "host-tuple"])
        .current_dir(workspace());
    let said = says(command.env("RUSTUP_AUTO_INSTALL", "0"))?;
    let (sysroot, host) = said
        .split_once('\n')
        .ok_or("rustc does not say where its libraries are")?;
    Ok((
        Path::new(sysroot).join("lib/rustlib"),
        host.trim().to_owned(),
    ))
}

/// A number in a version; part 0 is the first.
fn number(version: &str, part: usize) -> Option<u32> {
    version
        .split('.')
        .nth(part)?
        .trim_matches(|c: char| !c.is_ascii_digit())
        .parse()
        .ok()
}

/// An emulator from Debian's packages, installed, or unpacked for this project alone where they cannot be: where that would cost the
/// user another package, or another may do it. The first that runs: the system's, else this project's own.
pub(super) fn qemu(installs: bool, emulator: &Emulator) -> Result<PathBuf, String> {
    let Emulator {
        program,
        package,
        folder,
    } = *emulator;
    let folder = target().join(folder);
    let find = || {
        let mut why = "there is no such program".to_owned();
        for path in find(program)
            .into_iter()
            .chain(executable(folder.join(program)))
        {
            match says(Command::new(&path).arg("--version")) {
                Ok(_) => return Ok(path),
                Err(reason) => why = reason,
            }
        }
        Err(why)
    };
    let unpack = || {
        let mut unpack = Command::new("sh");
        unpack
            .arg(workspace().join(UNPACK_QEMU))
            .arg(&folder)
            .args([package, program])
            .env("LC_ALL", "C");
        attempt(
            &mut unpack,
            INSTALL,
            "unpacking QEMU, which cannot be installed",
        )
    };
    let ways: [Way; 2] = [
        (format!("apt-get installed {package}"), &|| {
            install_packages(&[package])
        }),
        (
            format!("{package} unpacked into {}", folder.display()),
            &unpack,
        ),
    ];
    bring(installs, find, &ways)
}

/// The program that would be run by this name.
pub fn find(program: &str) -> Option<PathBuf> {
    env::split_paths(&env::var_os("PATH")?).find_map(|folder| executable(folder.join(program)))
}

fn executable(path: PathBuf) -> Option<PathBuf> {
    fs::metadata(&path)
        .is_ok_and(|file| file.is_file() && file.permissions().mode() & 0o111 != 0)
        .then_some(path)
}

const NPM: Duration = Duration::from_secs(120);
const LEAST_NODE: u32 = 18;
/// Fails if the version of the Pico's emulator that is there is not the one to be had.
const ASK: &str = "const [{ dependencies }, { version }] = ['.', './node_modules/rp2040js']
    .map((folder) => require(folder + '/package.json'));
    if (version !== dependencies.rp2040js) throw 'another version'";

/// Node.js with the emulator of the Raspberry Pi Pico, a package of npm's, kept to one version.
pub(super) fn rp2040js(installs: bool) -> Result<PathBuf, Refused> {
    let find_node = || {
        let node = find("node").ok_or("there is no Node.js")?;
        let version = says(Command::new(&node).arg("--version"))?;
        let is_new = number(&version, 0).is_some_and(|number| number >= LEAST_NODE);
        if is_new {
            Ok(node)
        } else {
            Err(format!(
                "Node.js {} is older than {LEAST_NODE}",
                version.trim()
            ))
        }
    };
    let packages = || install_packages(&["nodejs", "npm"]);
    let node = bring(
        installs,
        find_node,
        &[("apt-get installed nodejs, npm".to_owned(), &packages)],
    )
    .map_err(|why| {
        missing(
            installs,
            "Node.js, of 18 or newer",
            &why,
            "this system's packages nodejs and npm",
        )
    })?;
    let folder = workspace().join("host-tests/rp2040");
    let fetched = || {
        let asked = says(
            Command::new(&node)
                .args(["--eval", ASK])
                .current_dir(&folder),
        );
        asked
            .map(drop)
            .map_err(|_| "npm has not fetched the version that is wanted".to_owned())
    };
    let npm = || {
        if find("npm").is_none() {
            install_packages(&["npm"])?;
        }
        let mut npm = Command::new("npm");
        npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"])
            .current_dir(&folder);
        attempt(
            &mut npm,
            NPM,
            "npm fetches the emulator of the Raspberry Pi Pico",
        )
    };
    let (what, by_hand) = (
        "the emulator of the Raspberry Pi Pico",
        "npm ci --prefix host-tests/rp2040",
    );
    bring(
        installs,
        fetched,
        &[("npm fetched rp2040js".to_owned(), &npm)],
    )
    .map_err(|why| missing(installs, what, &why, by_hand))?;
    Ok(node)
}
