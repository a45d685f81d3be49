//! `cargo fw`: how it ends, and which project it works on.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use host_tests::emulator::process::{Output, spawn};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

use super::cli::{output, program};
use crate::support::LIMIT;

fn fw(arguments: &[&str]) -> Output {
    output(program("fw").args(arguments))
}

#[test]
fn what_runs_for_ever_ends_well_when_it_is_told_to() {
    let told = fw(&["mps2-an386", "--seconds", "2"]);
    assert_eq!(told.status.code(), Some(0), "{}", told.stderr);
    assert!(told.stdout.contains("boot: mps2-an386"), "{}", told.stdout);
    assert_eq!(told.stderr.lines().last(), Some("ended after 2 s, as told"));
}

#[test]
fn a_failure_is_one_however_long_it_may_run() {
    assert_eq!(fw(&["inject-panic", "--seconds", "600"]).status.code(), Some(1));
}

#[test]
fn an_interrupt_leaves_nothing_in_the_temporary_folder() {
    let temporary = tempfile::tempdir().expect("there is room for it");
    let mut command = program("fw");
    command.arg("lm3s6965evb").env("TMPDIR", temporary.path());
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut fw = spawn(&mut command, LIMIT).unwrap_or_else(|error| panic!("{error}"));
    let mut log = BufReader::new(fw.stdout.take().expect("piped"));
    log.read_line(&mut String::new()).expect("the board says something");
    let left = || fs::read_dir(temporary.path()).expect("it is there").count();
    assert!(left() > 0, "the board has its folder there");
    kill(Pid::from_raw(fw.id().cast_signed()), Signal::SIGTERM).expect("it runs");
    assert_eq!(fw.wait().expect("it ends").code(), Some(143));
    assert_eq!(left(), 0);
}

/// A command that was built in one checkout and is run in another works on that one; outside of any it says so.
#[test]
fn the_project_is_the_one_that_a_command_is_run_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let (copy, checkout) = (folder.path().join("fw"), folder.path().join("checkout"));
    fs::copy(env!("CARGO_BIN_EXE_host-tests"), &copy).expect("a copy");
    for file in ["kernel/Cargo.toml", "firmware/Cargo.toml", "host-tests/Cargo.toml", "firmware/src/bin/elsewhere.rs"] {
        let file = checkout.join(file);
        fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
        fs::write(file, "").expect("a file");
    }
    let help = |within: &Path| {
        output(Command::new(&copy).args(["fw", "--help"]).current_dir(within).env_remove("CARGO_MANIFEST_DIR"))
    };
    let inside = help(&checkout.join("firmware/src"));
    assert!(inside.status.success() && inside.stdout.contains("Binaries:\n  elsewhere\n"), "{inside:?}");
    let Output { status, stdout, stderr } = help(folder.path());
    assert_eq!((status.code(), &*stdout, stderr.lines().count()), (Some(2), "", 1), "{stderr}");
}
