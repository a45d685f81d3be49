//! The search for each tool, and the ways to provide it.

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf, absolute};
use std::process::Command;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use std::{env, fs};

use super::bring::{Consent, INSTALL, Way, attempt, bring, install_packages, quick_output};
use super::{missing, target, workspace};
use console::cli::Refused;

/// Returns the folders that may contain Debian's compiler with the sources of the core library: the
/// system's programs, and the folder that the set-up unpacks into.
fn debian_folders() -> [PathBuf; 2] {
    [PathBuf::from("/usr/bin"), target().join(RUST_FOLDER)]
}

/// The folder in the target folder into which Debian's compiler is unpacked.
const RUST_FOLDER: &str = "rust";
/// The Debian packages that build the ARM core library.
pub(super) const CORE_PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
/// The time limit of `rustup target add`, which loads 40 MB. If it hangs, this time is lost once.
const RUSTUP: Duration = Duration::from_secs(60);
/// The script that downloads and unpacks Debian's packages.
const UNPACK: &str = "host-tests/emulator/src/toolchain/unpack.sh";

/// Debian's compiler, which builds the ARM core library from its sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct FromSource {
    /// The compiler.
    pub rustc: PathBuf,
    /// Its cargo.
    pub cargo: PathBuf,
    /// The folder that has rustup's `rust-lld`, which Debian's packages do not have.
    pub linker: PathBuf,
}

/// An emulator of the QEMU project.
pub(super) struct Emulator {
    /// The program that is run.
    pub program: &'static str,
    /// All programs of the package that are used.
    programs: &'static [&'static str],
    /// The Debian package that contains it.
    pub package: &'static str,
    /// The folder in the target folder into which the set-up unpacks it for this project.
    folder: &'static str,
}

/// The oldest major version of QEMU that supports all options used here: `-action` was added in
/// 6.0.
const LEAST_QEMU: u32 = 6;

/// The emulator of the boards.
pub(super) const QEMU: Emulator = Emulator {
    program: "qemu-system-arm",
    programs: &["qemu-system-arm"],
    package: "qemu-system-arm",
    folder: "qemu",
};
/// The programs that emulate Linux for other processors.
const USER_PROGRAMS: [&str; 2] = ["qemu-riscv32", "qemu-aarch64"];
/// The emulator of Linux on RISC-V.
pub(super) const QEMU_RISCV: Emulator = Emulator {
    program: "qemu-riscv32",
    programs: &USER_PROGRAMS,
    package: "qemu-user",
    folder: "qemu-user",
};
/// The emulator of Linux on aarch64.
pub(super) const QEMU_AARCH64: Emulator = Emulator {
    program: "qemu-aarch64",
    programs: &USER_PROGRAMS,
    package: "qemu-user",
    folder: "qemu-user",
};

/// Finds or provides the core library for these targets. It is either the ready-made one of rustup
/// for the compiler in use (`None`), or Debian's sources with their compiler. Only searches unless
/// `installs`. The error is the reasons of all failures, in one line.
pub(super) fn core(installs: bool, targets: &[&str]) -> Result<Option<FromSource>, String> {
    // The first way: rustup's ready-made library. It needs the network.
    let rustup = || {
        if find("rustup").is_none() {
            return Err("rustup was not found".to_owned());
        }
        let mut rustup = Command::new("rustup");
        rustup
            .args(["target", "add"])
            .args(targets)
            .current_dir(workspace())
            .env("RUSTUP_AUTO_INSTALL", "0");
        let doing = format!(
            "rustup fetches Rust's ARM library, for at most {} s",
            RUSTUP.as_secs()
        );
        attempt(&mut rustup, RUSTUP, &doing)
    };

    // The second way: Debian's compiler and sources, unpacked here.
    let folder = target().join(RUST_FOLDER);
    let debian = || {
        linker()?;
        unpack(&folder, &["rustc", "cargo"], &CORE_PACKAGES, INSTALL)
    };
    let ways: [Way; 2] = [
        (format!("rustup added {}", targets.join(", ")), &rustup),
        (unpacked(&folder, &CORE_PACKAGES), &debian),
    ];
    bring(installs, || find_core(targets), &ways)
}

/// Returns the report that packages have been unpacked into `folder`.
fn unpacked(folder: &Path, packages: &[&str]) -> String {
    format!("unpacked {} into {}", packages.join(", "), shown(folder))
}

/// Unpacks Debian's packages into `folder`, which changes nothing on the system.
fn unpack(
    folder: &Path,
    programs: &[&str],
    packages: &[&str],
    limit: Duration,
) -> Result<(), String> {
    if find("apt-get").is_none() {
        return Err(
            "there is no apt-get, which this command needs to unpack Debian's packages".to_owned(),
        );
    }
    let mut command = Command::new("sh");
    command
        .arg(workspace().join(UNPACK))
        .arg(folder)
        .args([programs.join(" "), packages.join(" ")])
        .env("LC_ALL", "C");
    let doing = format!("unpacking {} into {}", packages.join(", "), shown(folder));
    attempt(&mut command, limit, &doing)
}

/// Returns a path relative to the project, for messages.
fn shown(path: &Path) -> String {
    let within = path.strip_prefix(workspace()).unwrap_or(path);
    within.display().to_string()
}

/// Finds the core library for all of these targets, as [`core`] returns it. The error is the reason
/// why the library is not available.
fn find_core(targets: &[&str]) -> Result<Option<FromSource>, String> {
    // The library of the compiler in use, if rustup has installed it for all targets.
    let (in_use, _) = libraries("rustc".as_ref())?;
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

    // Debian's compiler, or the most specific reason why it is not usable.
    let mut why = "rustup has none for these targets".to_owned();
    for folder in debian_folders() {
        match from_source(&folder) {
            Ok(found) => return Ok(Some(found)),
            Err(Some(reason)) => why = reason,
            Err(None) => {}
        }
    }
    Err(why)
}

/// Finds Debian's compiler and its sources in a folder of programs. The error is `None` if the
/// folder contains none of them.
fn from_source(folder: &Path) -> Result<FromSource, Option<String>> {
    let [rustc, cargo] = ["rustc", "cargo"].map(|program| folder.join(program));
    let (libraries, _) = libraries(&rustc).map_err(|_| None)?;
    if !libraries.join("src/rust/library/core").is_dir() || !cargo.is_file() {
        let all = CORE_PACKAGES.join(", ");
        return Err(Some(format!(
            "not all of Debian's packages {all} are installed"
        )));
    }

    // Debian's compiler must be new enough for this workspace.
    let version = quick_output(Command::new(&rustc).arg("--version"))?;
    let least = env!("CARGO_PKG_RUST_VERSION");
    if number(&version, 1) < number(least, 1) {
        let version = version.trim();
        return Err(Some(format!("Debian's {version} is older than {least}")));
    }
    Ok(FromSource {
        rustc,
        cargo,
        linker: linker()?,
    })
}

/// Returns the folder of `rust-lld`, which Debian's packages do not have.
fn linker() -> Result<PathBuf, String> {
    let (libraries, host) = libraries("rustc".as_ref())?;
    let folder = libraries.join(host).join("bin");
    if folder.join("rust-lld").is_file() {
        return Ok(folder);
    }
    Err(format!(
        "there is no rust-lld in {}; the compiler of rustup.rs has one",
        folder.display()
    ))
}

/// Returns the folder of a compiler's libraries, and the compiler's name of the host.
fn libraries(rustc: &Path) -> Result<(PathBuf, String), String> {
    let mut command = Command::new(rustc);
    command
        .args(["--print", "sysroot", "--print", "host-tuple"])
        .current_dir(workspace());
    let output = quick_output(command.env("RUSTUP_AUTO_INSTALL", "0"))?;
    let (sysroot, host) = output
        .split_once('\n')
        .ok_or("rustc does not print where its libraries are")?;
    Ok((
        Path::new(sysroot).join("lib/rustlib"),
        host.trim().to_owned(),
    ))
}

/// Returns a number of a version; part 0 is the first.
fn number(version: &str, part: usize) -> Option<u32> {
    version
        .split('.')
        .nth(part)?
        .trim_matches(|c: char| !c.is_ascii_digit())
        .parse()
        .ok()
}

/// Finds an emulator, or unpacks Debian's package of it for this project.
///
/// The project's own emulator has priority: it was unpacked because the system's emulator was not
/// usable. Only searches unless `installs`. The error is the reasons of all failures, in one line,
/// such as a version before 6.0.
pub(super) fn qemu(installs: bool, emulator: &Emulator) -> Result<PathBuf, String> {
    let Emulator {
        program,
        programs,
        package,
        folder,
    } = *emulator;
    let folder = target().join(folder);
    // The project's own emulator first, then the system's.
    let look = || {
        if let Some(own) = executable(folder.join(program)).filter(|own| judged(own).is_ok()) {
            return Ok(own);
        }
        let path = find(program).ok_or_else(|| format!("there is no {program} on PATH"))?;
        judged_once(&path).map(|()| path)
    };
    let way = || unpack(&folder, programs, &[package], INSTALL);
    let ways: [Way; 1] = [(unpacked(&folder, &[package]), &way)];
    bring(installs, look, &ways)
}

/// Returns an error if a QEMU does not print its version or is too old.
fn judged(path: &Path) -> Result<(), String> {
    let shown = path.display();
    let output = quick_output(Command::new(path).arg("--version"))
        .map_err(|why| format!("{shown} does not work ({why})"))?;

    // The version follows the word "version" and ends at a space or a bracket.
    let version = output
        .split_once("version ")
        .and_then(|(_, rest)| rest.split(|c: char| c.is_whitespace() || c == '(').next());
    let Some((version, major)) = version.and_then(|version| Some((version, number(version, 0)?)))
    else {
        return Err(format!("{shown} does not print its version"));
    };
    if major < LEAST_QEMU {
        return Err(format!(
            "{shown} is QEMU {version}, which is too old: {LEAST_QEMU}.0 or newer is needed"
        ));
    }
    Ok(())
}

/// Returns the result of [`judged`], which is called once per program and process. A program that
/// hangs would otherwise cost its time limit in every search.
fn judged_once(path: &Path) -> Result<(), String> {
    type Verdict = (PathBuf, Result<(), String>);
    static VERDICTS: Mutex<Vec<Verdict>> = Mutex::new(Vec::new());
    let mut verdicts = VERDICTS.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, verdict)) = verdicts.iter().find(|(judged, _)| judged == path) {
        return verdict.clone();
    }
    let verdict = judged(path);
    verdicts.push((path.to_owned(), verdict.clone()));
    verdict
}

/// Returns the program that the shell would run for this name, or `None` if no folder of `PATH` has
/// it or `PATH` is not set. A file that nobody may execute is passed over. The path is absolute,
/// also if that folder is relative. Not checked: that the name has no slash, for which the shell
/// would not search.
pub fn find(program: &str) -> Option<PathBuf> {
    env::split_paths(&env::var_os("PATH")?)
        .find_map(|folder| executable(absolute(folder.join(program)).ok()?))
}

/// Returns the path if it is a file that may be executed.
fn executable(path: PathBuf) -> Option<PathBuf> {
    fs::metadata(&path)
        .is_ok_and(|file| file.is_file() && file.permissions().mode() & 0o111 != 0)
        .then_some(path)
}

/// Chromium without windows, by its name in Debian.
const BROWSER: &str = "chromium-headless-shell";
/// The time limit to fetch and unpack 100 MB.
const FETCH_BROWSER: Duration = Duration::from_secs(180);

/// Finds a Chromium that prints its version, on `PATH` first, or unpacks Debian's for this project.
/// The error is the reasons of all failures, in one line.
pub(super) fn chromium() -> Result<PathBuf, String> {
    let folder = target().join("chromium");
    let packages = [BROWSER, "chromium-common"];
    let look = || {
        let own = executable(folder.join(BROWSER));
        let all = ["chromium", "google-chrome", BROWSER].map(find);
        let mut all = all.into_iter().chain([own]).flatten();
        all.find(|path| quick_output(Command::new(path).arg("--version")).is_ok())
            .ok_or_else(|| "there is neither chromium nor google-chrome on PATH".to_owned())
    };
    let way = || unpack(&folder, &[BROWSER], &packages, FETCH_BROWSER);
    bring(true, look, &[(unpacked(&folder, &packages), &way)])
}

/// The time limit of npm.
const NPM: Duration = Duration::from_secs(120);
/// The oldest major version of Node.js that is used.
const LEAST_NODE: u32 = 18;
/// A script that fails if the installed version of the Pico's emulator differs from the required
/// one.
const ASK: &str = "const [{ dependencies }, { version }] = ['.', './node_modules/rp2040js']
    .map((folder) => require(folder + '/package.json'));
    if (version !== dependencies.rp2040js) throw 'another version'";

/// Finds a version of Node.js that runs the emulator of the Pico and WebAssembly modules, 18 or
/// newer, or installs it with the user's consent. Without a `consent` it only searches. If there is
/// none, it is refused, with the remedy.
pub(super) fn node(consent: Option<Consent>) -> Result<PathBuf, Refused> {
    let installs = consent.is_some();
    let install = |packages: &[&str]| install_packages(packages, consent.unwrap_or(Consent::Ask));
    let find_node = || {
        // Node.js must be present and new enough.
        let node = find("node").ok_or("there is no node on PATH")?;
        let version = quick_output(Command::new(&node).arg("--version"))?;
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
    let packages = || install(&["nodejs", "npm"]);
    bring(
        installs,
        find_node,
        &[("apt-get installed nodejs, npm".to_owned(), &packages)],
    )
    .map_err(|why| {
        missing(
            consent == Some(Consent::Given),
            "Node.js",
            &why,
            "cargo setup --yes",
            "install this system's packages nodejs and npm, Node.js 18 or newer",
        )
    })
}

/// Returns Node.js with the emulator of the Raspberry Pi Pico, an npm package with a fixed version.
/// With a `consent`, provides them if they are missing; npm needs none to fetch the emulator. If
/// one is missing in the end, it is refused, with the remedy.
pub(super) fn rp2040js(consent: Option<Consent>) -> Result<PathBuf, Refused> {
    let node = node(consent)?;
    let installs = consent.is_some();
    let install = |packages: &[&str]| install_packages(packages, consent.unwrap_or(Consent::Ask));
    let folder = workspace().join("host-tests/emulator/rp2040");
    // The installed version is compared with the required one.
    let fetched = || {
        let checked = quick_output(
            Command::new(&node)
                .args(["--eval", ASK])
                .current_dir(&folder),
        );
        checked
            .map(drop)
            .map_err(|_| "the version needed has not been fetched".to_owned())
    };

    // npm fetches exactly the versions of the lock file, without running their scripts.
    let npm = || {
        if find("npm").is_none() {
            install(&["npm"])?;
        }
        let mut npm = Command::new("npm");
        npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund"])
            .current_dir(&folder);
        attempt(&mut npm, NPM, "npm fetches rp2040js")
    };
    let what = "the emulator of the Raspberry Pi Pico";
    let by_hand = "run npm ci --prefix host-tests/emulator/rp2040";
    bring(
        installs,
        fetched,
        &[("npm fetched rp2040js".to_owned(), &npm)],
    )
    .map_err(|why| missing(installs, what, &why, "cargo setup", by_hand))?;
    Ok(node)
}
