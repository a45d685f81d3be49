//! `cargo setup` with fakes of the system's programs: it unpacks packages for this project, and
//! installs packages on the system only after a question.

use std::fs::{self, File, Permissions};
use std::io::{Read, Write};
use std::os::unix::fs::{OpenOptionsExt, PermissionsExt};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use emulator::process::{Output, spawn};
use nix::fcntl::OFlag;
use nix::pty::{grantpt, posix_openpt, ptsname_r, unlockpt};
use nix::unistd::geteuid;
use tempfile::TempDir;

use super::cli::{output, program};
use crate::support::LIMIT;

const GOOD_QEMU: &str = "echo QEMU emulator version 9.0.2";
const GOOD_NODE: &str = "echo v20.1.0";
const OLD_NODE: &str = "echo v12.22.12";

/// A fake that logs its calls. If a package is requested, it prints the name of a file and then
/// makes the file. An installation makes a new Node.js.
const APT_GET: &str = r#"
echo "$@" >> "$LOG"
case "$*" in
    *--print-uris*) echo "'http://nowhere/q.deb' qemu-system-arm_9.0_all.deb 1 MD5Sum:0" ;;
    *download*) touch qemu-system-arm_9.0_all.deb ;;
    *update*) ;;
    *install*) printf '#!/bin/sh\necho v20.1.0\n' > "$(dirname "$0")/node" ;;
esac"#;
/// A fake that extracts a QEMU from any package.
const DPKG_DEB: &str = r#"
mkdir -p usr/bin
printf '#!/bin/sh\necho QEMU emulator version 9.0.2\n' > usr/bin/qemu-system-arm
chmod 755 usr/bin/qemu-system-arm"#;

/// A system whose programs are fakes, and an empty target folder.
struct System {
    folder: TempDir,
}

impl System {
    /// Makes a system with these scripts as QEMU and Node.js.
    fn new(qemu: &str, node: &str) -> Self {
        let system = Self {
            folder: tempfile::tempdir().expect("a folder"),
        };
        for folder in ["bin", "target"] {
            fs::create_dir(system.path(folder)).expect("a folder");
        }
        // The fakes are first on the PATH.
        for (name, script) in [
            ("qemu-system-arm", qemu),
            ("node", node),
            ("npm", "exit 0"),
            ("apt-get", APT_GET),
            ("dpkg-deb", DPKG_DEB),
        ] {
            let path = system.path("bin").join(name);
            fs::write(&path, format!("#!/bin/sh\n{script}\n")).expect("a program");
            fs::set_permissions(path, Permissions::from_mode(0o755)).expect("its mode");
        }
        system
    }

    /// Returns the path of a file or folder of the system.
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Returns a set-up on the system.
    fn setup(&self, arguments: &[&str]) -> Command {
        let rest = std::env::var_os("PATH").unwrap_or_default();
        let path = std::iter::once(self.path("bin")).chain(std::env::split_paths(&rest));
        let mut command = program("setup");
        command
            .args(arguments)
            .env("PATH", std::env::join_paths(path).expect("a path"))
            .env("CARGO_TARGET_DIR", self.path("target"))
            .env("LOG", self.path("log"));
        command
    }

    /// Returns the calls of apt-get that install packages on the system.
    fn installed(&self) -> Vec<String> {
        let log = fs::read_to_string(self.path("log")).unwrap_or_default();
        let installs = |line: &&str| line.contains("install") && !line.contains("--print-uris");
        log.lines().filter(installs).map(str::to_owned).collect()
    }
}

/// The system's QEMU is too old, does not run or prints no version. The set-up reports that,
/// unpacks another one into the target folder and installs nothing on the system. The next set-up
/// finds everything ready.
#[test]
fn a_qemu_that_is_old_or_broken_is_replaced_by_an_unpacked_one() {
    for (qemu, reason) in [
        (
            "echo 'QEMU emulator version 2.11.1(Debian 1:2.11)'",
            "is QEMU 2.11.1, which is too old: 6.0 or newer is needed",
        ),
        ("exit 127", "does not work ("),
        ("echo hello", "does not print its version"),
    ] {
        let system = System::new(qemu, GOOD_NODE);
        let unpacked = system.path("target").join("qemu/qemu-system-arm");
        let result = output(&mut system.setup(&[]));
        assert_eq!(result.status.code(), Some(0), "{result:?}");
        assert!(result.stderr.contains(reason), "{result:?}");
        let line = format!("QEMU: {}\n", unpacked.display());
        assert!(result.stdout.contains(&line), "{result:?}");
        assert_eq!(system.installed(), [""; 0]);

        // The next set-up finds the unpacked program.
        let again = output(&mut system.setup(&[]));
        assert!(again.stdout.contains("everything was ready"), "{again:?}");
    }
}

/// A QEMU of the system that is new enough is used, and apt-get is not called.
#[test]
fn a_good_qemu_of_the_system_is_used() {
    let system = System::new(GOOD_QEMU, GOOD_NODE);
    let result = output(&mut system.setup(&[]));
    let line = format!("QEMU: {}\n", system.path("bin/qemu-system-arm").display());
    assert!(result.stdout.contains(&line), "{result:?}");
    assert!(!system.path("log").exists(), "apt-get was called");
}

/// A QEMU in a relative folder of `PATH` is found, and named by its absolute path, because it runs
/// in another folder.
#[test]
fn a_qemu_in_a_relative_folder_of_path_has_an_absolute_path() {
    let system = System::new(GOOD_QEMU, GOOD_NODE);
    let rest = std::env::var_os("PATH").unwrap_or_default();
    let path = std::iter::once("bin".into()).chain(std::env::split_paths(&rest));
    let mut setup = system.setup(&[]);
    setup
        .env("PATH", std::env::join_paths(path).expect("a path"))
        .current_dir(system.folder.path());
    let result = output(&mut setup);
    let line = format!("QEMU: {}\n", system.path("bin/qemu-system-arm").display());
    assert!(result.stdout.contains(&line), "{result:?}");
}

/// Node.js is too old. Without a terminal the set-up has exit code 2, one error with the remedy,
/// and installs nothing. With `--yes` root installs nodejs and npm.
#[test]
fn without_a_terminal_packages_are_installed_by_yes_only() {
    let system = System::new(GOOD_QEMU, OLD_NODE);
    let result = output(&mut system.setup(&[]));
    assert_eq!(result.status.code(), Some(2), "{result:?}");
    let errors: Vec<_> = result
        .stderr
        .lines()
        .filter(|line| line.contains("error: "))
        .collect();
    let [error] = errors[..] else {
        panic!("{result:?}")
    };
    assert!(
        error.starts_with("error: Node.js is missing: Node.js v12.22.12 is older than 18; ")
            && error.contains(
                "; run cargo setup --yes, or install this system's packages nodejs and npm"
            ),
        "{error}"
    );
    assert_eq!(system.installed(), [""; 0]);

    // With the user's consent the packages are installed, if the user may do that.
    if geteuid().is_root() {
        let result = output(&mut system.setup(&["--yes"]));
        assert_eq!(result.status.code(), Some(0), "{result:?}");
        assert!(
            system.installed()[0].ends_with("nodejs npm"),
            "{:?}",
            system.installed()
        );
    }
}

/// Runs the set-up on a terminal where this text is typed. Returns its output and the text on the
/// terminal.
fn typed(system: &System, text: &str) -> (Output, String) {
    let master =
        posix_openpt(OFlag::O_RDWR | OFlag::O_NOCTTY | OFlag::O_CLOEXEC).expect("a terminal");
    grantpt(&master)
        .and_then(|()| unlockpt(&master))
        .expect("a terminal");
    // Every end of the terminal is opened again, because the command closes its own.
    let name = ptsname_r(&master).expect("its name");
    let end = || {
        let mut options = File::options();
        options
            .read(true)
            .write(true)
            .custom_flags(OFlag::O_NOCTTY.bits());
        Stdio::from(options.open(&name).expect("its end"))
    };

    let mut command = system.setup(&[]);
    command.stdin(end()).stderr(end()).stdout(Stdio::null());

    // The text is typed in advance, and read when the question is asked.
    let mut master = File::from(std::os::fd::OwnedFd::from(master));
    master.write_all(text.as_bytes()).expect("it is typed");
    let mut running = spawn(&mut command, LIMIT).expect("it starts");
    drop(command);
    let status = running.wait().expect("it ends");

    // A terminal without users ends with an error.
    let mut shown = Vec::new();
    let _ = master.read_to_end(&mut shown);
    let shown = String::from_utf8_lossy(&shown).into_owned();
    let output = Output {
        status,
        stdout: String::new(),
        stderr: shown.clone(),
    };
    (output, shown)
}

/// Node.js is too old, and root runs the set-up on a terminal. It asks; packages are installed
/// after "y", and after "n" or an empty line they are not and the exit code is 2. For other users
/// this test does nothing.
#[test]
fn on_a_terminal_the_user_is_asked() {
    // Other users are not asked, because only root may install packages.
    if !geteuid().is_root() {
        return;
    }
    for (answer, code, installed) in [("\n", 2, 0), ("n\n", 2, 0), ("y\n", 0, 1)] {
        let system = System::new(GOOD_QEMU, OLD_NODE);
        let (output, shown) = typed(&system, answer);
        assert!(
            shown.contains("Install nodejs, npm on this system with apt-get? [y/N] "),
            "{shown}"
        );
        assert_eq!(output.status.code(), Some(code), "{answer:?}: {shown}");
        assert_eq!(system.installed().len(), installed, "{answer:?}: {shown}");
    }
}
