//! What is there already. Runs nothing that changes anything.

use std::env;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use super::{ArmCore, Qemu, TARGETS, target, workspace};
use crate::emulator::process::run;

/// For a program that only says its version.
const QUICK: Duration = Duration::from_secs(20);
/// Debian's compiler, whatever the PATH says.
pub(super) const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
/// Debian's cargo, whatever the PATH says.
pub(super) const DEBIAN_CARGO: &str = "/usr/bin/cargo";
/// The Debian packages that build the ARM core library; the first is the compiler.
pub(super) const CORE_PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];
/// The emulator, and its Debian package.
pub(super) const QEMU: &str = "qemu-system-arm";
/// What apt-get, dpkg, rustup and npm begin the line with in which they say what went wrong.
const MARKS: [&str; 5] = ["E: ", "error: ", "npm ERR! network ", "npm error network ", "npm error "];
/// How much of a failed command's own words is passed on, in characters.
const LONGEST_REASON: usize = 200;

/// The core library: ready-made beside the compiler in use, else Debian's sources.
pub(super) fn arm_core() -> Result<ArmCore, String> {
    let (libraries, _) = libraries()?;
    let has_core = |target: &str| {
        let files = fs::read_dir(libraries.join(target).join("lib")).into_iter().flatten().flatten();
        files.into_iter().any(|file| file.file_name().as_encoded_bytes().starts_with(b"libcore-"))
    };
    if TARGETS.into_iter().all(has_core) {
        return Ok(ArmCore::ReadyMade);
    }
    let mut packages = Command::new("dpkg-query");
    packages.args(["--show", "--showformat=${Package} ${db:Status-Status} ${Version}\\n"]).args(CORE_PACKAGES);
    let listing = says(&mut packages).map_err(|_| "neither rustup nor Debian has brought one")?;
    Ok(ArmCore::FromSource { version: debian_compiler(&listing)?, linker: linker()? })
}

/// The folder of `rust-lld`, which Debian's packages do not have.
pub(super) fn linker() -> Result<PathBuf, String> {
    let (libraries, host) = libraries()?;
    let folder = libraries.join(host).join("bin");
    if folder.join("rust-lld").is_file() {
        return Ok(folder);
    }
    Err(format!("there is no rust-lld in {}; the compiler of rustup.rs has one", folder.display()))
}

/// Where the compiler in use has its libraries, and its name of the host.
fn libraries() -> Result<(PathBuf, String), String> {
    let mut command = Command::new("rustc");
    command.args(["--print", "sysroot", "--print", "host-tuple"]).current_dir(workspace());
    let said = says(command.env("RUSTUP_AUTO_INSTALL", "0"))?;
    let (sysroot, host) = said.split_once('\n').ok_or("rustc does not say where its libraries are")?;
    Ok((Path::new(sysroot).join("lib/rustlib"), host.trim().to_owned()))
}

/// Debian's compiler, by a line for each of its packages: all are wholly installed, and it is not too old for this workspace.
fn debian_compiler(listing: &str) -> Result<String, String> {
    let minor = |version: &str| version.split('.').nth(1)?.parse::<u32>().ok();
    let mut version = "";
    for line in listing.lines() {
        match line.split(' ').collect::<Vec<_>>()[..] {
            [package, "installed", its] if package == CORE_PACKAGES[0] => version = its,
            [_, "installed", _] => {}
            _ => return Err(format!("dpkg has not finished installing {}", CORE_PACKAGES.join(", "))),
        }
    }
    let least = env!("CARGO_PKG_RUST_VERSION");
    if minor(version) < minor(least) {
        return Err(format!("Debian's rustc {version} is older than {least}"));
    }
    Ok(format!("rustc {}", version.split(['+', '~', '-']).next().unwrap_or(version)))
}

/// Where the set-up unpacks an emulator for this project alone.
pub(super) fn own_qemu_folder() -> PathBuf {
    target().join("qemu")
}

/// The first emulator that runs: the system's, else this project's own.
pub(super) fn qemu() -> Result<Qemu, String> {
    let mut why = "there is no such program".to_owned();
    for path in find(QEMU).into_iter().chain(executable(own_qemu_folder().join(QEMU))) {
        match says(Command::new(&path).arg("--version")) {
            Ok(version) => {
                let version = version.lines().next().unwrap_or_default();
                let version = version.strip_prefix("QEMU emulator version ").unwrap_or(version).to_owned();
                return Ok(Qemu { path, version });
            }
            Err(reason) => why = format!("{} does not run: {reason}", path.display()),
        }
    }
    Err(why)
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
    let output = run(command, QUICK).map_err(|error| error.to_string())?;
    if output.status.success() { Ok(output.stdout) } else { Err(reason(&output.stderr)) }
}

/// Why a command failed, from what it said: the line in which it says so.
pub(super) fn reason(said: &str) -> String {
    // dpkg says it in the middle of a line, and apt-get sums up that dpkg has failed.
    if said.contains("No space left on device") {
        return "the disk is full".to_owned();
    }
    let marked = |mark: &&str| said.lines().find_map(|line| line.strip_prefix(*mark));
    let line = MARKS.iter().find_map(marked).or_else(|| said.lines().last());
    line.unwrap_or("it fails without a word").chars().take(LONGEST_REASON).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_commands_own_reason_is_found() {
        for (said, why) in [
            (
                "Err:1 http://deb.debian.org\nE: Failed to fetch: no network\nE: Some index",
                "Failed to fetch: no network",
            ),
            ("E: dpkg was interrupted, you must ...", "dpkg was interrupted, you must ..."),
            ("info: syncing\nerror: could not download\n", "could not download"),
            ("npm error code EAI\nnpm error network request failed\nnpm error A log", "request failed"),
            ("dpkg: error:\n failed to write (No space left on device)\nE: Sub-process", "the disk is full"),
            ("error while loading shared libraries: libfdt", "error while loading shared libraries: libfdt"),
            ("", "it fails without a word"),
        ] {
            assert_eq!(reason(said), why);
        }
    }

    #[test]
    fn debians_compiler_counts_if_it_is_whole_and_new_enough() {
        let listing = |state: &str, version: &str| {
            format!("cargo-web installed 1.96.0\nrust-web-src {state} {version}\nrustc-web installed {version}\n")
        };
        assert_eq!(debian_compiler(&listing("installed", "1.96.0+dfsg1-1~deb12u2")), Ok("rustc 1.96.0".to_owned()));
        let old = debian_compiler(&listing("installed", "1.85.0+dfsg3-1~deb12u3"));
        assert!(old.is_err_and(|why| why.contains("1.85.0") && why.contains("is older than 1.88")));
        let half = debian_compiler(&listing("unpacked", "1.96.0"));
        assert!(half.is_err_and(|why| why.starts_with("dpkg has not finished installing rustc-web")));
        assert!(debian_compiler("").is_err());
    }
}
