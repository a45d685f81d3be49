//! Installation of missing tools.

use std::fs::{self, File};
use std::io::{self, IsTerminal, Write};
use std::process::Command;
use std::time::Duration;

use nix::fcntl::{Flock, FlockArg};

use super::target;
use super::tools::find;
use crate::process::{Output, run, run_watched};
use console::cli::{Refused, complain};
use console::progress::Progress;

/// The time limit of a program that only prints information, 20 s. It is killed then, which is an
/// error.
pub const QUICK: Duration = Duration::from_secs(20);
/// The time limit to fetch and unpack at most 400 MB, and to wait for dpkg: 20 minutes.
pub(super) const INSTALL: Duration = Duration::from_secs(1200);

/// Waits until no other set-up runs, without a limit, and locks set-ups. The lock ends when it is
/// dropped or when the process ends in any way. Another call in this process waits, too, so a
/// thread that has the lock must not call this. Makes the target folder, which has the lock;
/// refused if it cannot be made or locked.
pub(super) fn turn() -> Result<Flock<File>, Refused> {
    let refuse = |error: io::Error| {
        Refused::because(format_args!("cannot lock {}: {error}", target().display()))
    };
    let folder = fs::create_dir_all(target())
        .and_then(|()| File::open(target()))
        .map_err(refuse)?;
    Flock::lock(folder, FlockArg::LockExclusive).map_err(|(_, error)| refuse(error.into()))
}

/// A way to install something: the report of success, and the function that installs it, whose
/// error is the reason in one line. The tool must be found afterwards, too.
pub(super) type Way<'a> = (String, &'a dyn Fn() -> Result<(), String>);

/// Returns the result of `find`. If `find` fails and `installs` is true, tries the `ways` in order
/// until `find` succeeds. If none succeeds, the error is the reasons of all failures, in one line
/// and each once. The success of a way is reported on stderr, with the failures before it.
pub(super) fn bring<T>(
    installs: bool,
    find: impl Fn() -> Result<T, String>,
    ways: &[Way],
) -> Result<T, String> {
    let mut failures = match find() {
        Ok(found) => return Ok(found),
        Err(why) => vec![why],
    };
    // Each way is followed by a new search, because an installation may succeed without effect.
    for (done, way) in ways.iter().filter(|_| installs) {
        match way().and_then(|()| find()) {
            Ok(found) => {
                complain(format_args!("{done}: {}", failures.join("; ")));
                return Ok(found);
            }
            Err(failure) if failures.contains(&failure) => {}
            Err(failure) => failures.push(failure),
        }
    }
    Err(failures.join("; "))
}

/// The user's consent to install packages on the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Consent {
    /// Asks the user on the terminal and waits for the answer without a limit. Only `y` and `yes`,
    /// in capitals too, are a consent. After another answer, or unless standard input and standard
    /// error are a terminal, nothing is installed, and the tool stays missing.
    Ask,
    /// The user has passed `--yes`. There is no question.
    Given,
}

impl Consent {
    /// Asks the user if necessary. Returns an error with the reason if `packages` must not be
    /// installed.
    fn obtain(self, packages: &str) -> Result<(), String> {
        if self == Consent::Given {
            return Ok(());
        }
        let input = io::stdin();
        let output = io::stderr();
        // Without a terminal nobody can answer.
        if !(input.is_terminal() && output.is_terminal()) {
            return Err(format!(
                "{packages} would be installed on the system, which needs --yes"
            ));
        }
        let mut answer = String::new();
        let asked = write!(
            &output,
            "Install {packages} on this system with apt-get? [y/N] "
        )
        .and_then(|()| (&output).flush())
        .and_then(|()| input.read_line(&mut answer));
        let is_yes = ["y", "yes"].contains(&&*answer.trim().to_lowercase());
        if asked.is_ok() && is_yes {
            Ok(())
        } else {
            Err(format!("{packages} not installed, as answered"))
        }
    }
}

/// Installs Debian packages on the system. The lists of packages are updated first, because old
/// ones may contain packages that no longer exist. An error is the reason in one line: no apt-get,
/// not root, no consent, or a failed installation. Does not check that the programs work.
pub(super) fn install_packages(packages: &[&str], consent: Consent) -> Result<(), String> {
    if find("apt-get").is_none() {
        return Err(
            "this system has no apt-get, the only package manager this command runs".to_owned(),
        );
    }
    if !nix::unistd::geteuid().is_root() {
        return Err("only root may install packages".to_owned());
    }
    consent.obtain(&packages.join(", "))?;

    let updated = attempt(
        &mut apt_get("update"),
        INSTALL,
        "apt-get fetches the lists of packages",
    );
    let mut install = apt_get("install");
    install
        .args(["--no-install-recommends", "--no-remove", "--reinstall"])
        .args(packages);

    // One bad source among several does not prevent the installation. If the installation fails
    // too, the failed update of the lists is the cause.
    attempt(
        &mut install,
        INSTALL,
        &format!("apt-get installs {}", packages.join(", ")),
    )
    .map_err(|failure| updated.err().unwrap_or(failure))
}

/// Returns an `apt-get` command that asks nothing, waits for the lock of dpkg, and does not wait
/// for a dead network.
fn apt_get(action: &str) -> Command {
    let mut command = Command::new("apt-get");
    command.args([action, "--yes", "--quiet"]);
    for option in [
        "DPkg::Lock::Timeout=120",
        "Dpkg::Use-Pty=0",
        "Acquire::http::Timeout=30",
        "Acquire::Retries=1",
    ] {
        command.args(["-o", option]);
    }
    command
        .env("DEBIAN_FRONTEND", "noninteractive")
        .env("LC_ALL", "C");
    command
}

/// Runs a command to its end and shows progress on stderr, with `doing` as its name. An error is
/// the reason in one line: the command cannot be started, fails, or is killed after `limit`.
pub(super) fn attempt(command: &mut Command, limit: Duration, doing: &str) -> Result<(), String> {
    output_or_reason(command, |command| run_shown(command, limit, doing)).map(drop)
}

/// Runs a command as [`run_watched`] does, and shows progress on stderr meanwhile, with `doing` as
/// its name. A failure of the program is not an error; its time limit is.
pub(super) fn run_shown(command: &mut Command, limit: Duration, doing: &str) -> io::Result<Output> {
    let progress = Progress::start(doing);
    run_watched(command, limit, |line| progress.alive(line))
}

/// Returns the standard output of a quick command. An error is the reason in one line: it cannot be
/// started, fails, or is killed after [`QUICK`].
pub(super) fn quick_output(command: &mut Command) -> Result<String, String> {
    output_or_reason(command, |command| run(command, QUICK))
}

/// Returns the output of a command, or the line with the reason of its failure.
fn output_or_reason(
    command: &mut Command,
    run: impl FnOnce(&mut Command) -> io::Result<Output>,
) -> Result<String, String> {
    let output = run(command).map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(output.stdout);
    }

    // The line with the reason has one of these marks, or else is the last line.
    let lines = || output.stderr.lines();
    let marked = |mark: &&str| lines().find(|line| line.contains(*mark));
    let marks = ["No space left on device", "E: ", "error: ", "npm "];
    let line = marks.iter().find_map(marked).or_else(|| lines().last());
    let line: String = line
        .unwrap_or("it failed without a message")
        .chars()
        .take(200)
        .collect();
    Err(format!(
        "{}: {line}",
        command.get_program().to_string_lossy()
    ))
}
