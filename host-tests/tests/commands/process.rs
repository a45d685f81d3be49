//! Supervised children are gone when they should be. Whether a process is gone is seen from a pipe it inherited: the
//! end of file comes when the last holder has gone, and one that outlives its owner writes "survived" first.

use std::io::{BufRead, BufReader, Read};
use std::path::PathBuf;
use std::process::{ChildStdout, Command, Stdio};
use std::time::Duration;

use host_tests::emulator::process::{
    ProcessError, Running, on_interrupt, remove_on_interrupt, run, run_watched, spawn,
};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

/// Far longer than any of these children needs.
const AMPLE: Duration = Duration::from_secs(60);
/// For those that must be stopped.
const SHORT: Duration = Duration::from_millis(300);
/// A leader with a child of its own, both of which would outlive everything here.
const FAMILY: &str = "(sleep 20; echo survived) & echo ready; sleep 20; echo survived";
/// The environment variable that turns [`interrupted_helper`] from an empty test into the process to interrupt.
const HELPER: &str = "PROCESS_TEST_HELPER";

fn shell(script: &str) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", script]).stdin(Stdio::null()).stdout(Stdio::piped());
    command
}

fn first_line(pipe: &mut BufReader<ChildStdout>) -> String {
    let mut line = String::new();
    pipe.read_line(&mut line).expect("the pipe can be read");
    line
}

fn rest(mut pipe: BufReader<ChildStdout>) -> String {
    let mut text = String::new();
    pipe.read_to_string(&mut text).expect("the pipe can be read");
    text
}

#[test]
fn output_and_status_are_captured() {
    let output = run(&mut shell("echo out; echo err >&2; exit 7"), AMPLE).expect("it runs");
    assert_eq!((output.stdout.as_str(), output.stderr.as_str(), output.status.code()), ("out\n", "err\n", Some(7)));
}

#[test]
fn much_output_on_both_streams_does_not_block() {
    let script = "i=0; while [ $i -lt 20000 ]; do echo 0123456789; echo 0123456789 >&2; i=$((i+1)); done";
    let mut lines = 0;
    let output = run_watched(&mut shell(script), AMPLE, |line| lines += usize::from(line.is_some())).expect("it runs");
    assert_eq!((output.stdout.len(), output.stderr.len(), lines), (220_000, 220_000, 40_000));
}

#[test]
fn the_watcher_hears_that_a_silent_child_is_alive() {
    let mut ticks = 0;
    run_watched(&mut shell("sleep 1"), AMPLE, |line| ticks += usize::from(line.is_none())).expect("it runs");
    assert!(ticks > 0);
}

#[test]
fn a_missing_program_is_named() {
    let error = run(&mut Command::new("no-such-program"), AMPLE).expect_err("it does not exist");
    assert!(error.to_string().starts_with("cannot start no-such-program: "), "{error}");
}

#[test]
fn the_time_limit_ends_the_whole_group() {
    let mut child = spawn(&mut shell(FAMILY), SHORT).expect("it starts");
    let pipe = BufReader::new(child.stdout.take().expect("piped"));
    assert!(matches!(child.wait(), Err(ProcessError::TimedOut { limit: SHORT, .. })));
    assert_eq!(rest(pipe), "ready\n");
}

#[test]
fn the_time_limit_holds_while_nobody_waits() {
    let mut child = spawn(&mut shell(FAMILY), SHORT).expect("it starts");
    assert_eq!(rest(BufReader::new(child.stdout.take().expect("piped"))), "ready\n");
}

#[test]
fn the_time_limit_ends_a_child_that_will_not_stop() {
    let mut child = spawn(&mut shell(&format!("trap '' TERM; {FAMILY}")), SHORT).expect("it starts");
    let pipe = BufReader::new(child.stdout.take().expect("piped"));
    assert!(matches!(child.wait(), Err(ProcessError::TimedOut { .. })));
    assert_eq!(rest(pipe), "ready\n");
}

#[test]
fn letting_go_ends_the_whole_group() {
    let mut child = spawn(&mut shell(FAMILY), AMPLE).expect("it starts");
    let mut pipe = BufReader::new(child.stdout.take().expect("piped"));
    assert_eq!(first_line(&mut pipe), "ready\n");
    drop(child);
    assert_eq!(rest(pipe), "");
}

#[test]
fn what_an_ended_child_leaves_behind_is_ended() {
    let output = run(&mut shell("(sleep 20; echo survived) & echo done"), AMPLE).expect("it runs");
    assert_eq!((output.stdout.as_str(), output.status.code()), ("done\n", Some(0)));
}

#[test]
fn an_interrupt_ends_the_children_and_then_this_process() {
    for (signal, code) in [(Signal::SIGINT, 130), (Signal::SIGTERM, 143), (Signal::SIGHUP, 129)] {
        let (mut helper, pipe, folder) = helper();
        kill(Pid::from_raw(helper.id() as i32), signal).expect("it runs");
        assert_eq!(helper.wait().expect("it ends").code(), Some(code), "{signal}");
        assert_eq!(rest(pipe), "hook\n", "{signal}");
        assert!(!folder.exists(), "{signal}: {} is left", folder.display());
    }
}

#[test]
fn children_do_not_outlive_a_killed_process() {
    let (mut helper, pipe, folder) = helper();
    kill(Pid::from_raw(helper.id() as i32), Signal::SIGKILL).expect("it runs");
    assert_eq!(rest(pipe), "");
    helper.wait().expect("it ends");
    std::fs::remove_dir_all(folder).expect("nobody else could");
}

/// The process to interrupt, its output after its family is ready, and its folder.
fn helper() -> (Running, BufReader<ChildStdout>, PathBuf) {
    let mut helper = Command::new(std::env::current_exe().expect("a test has a path"));
    helper.args(["--exact", "process::interrupted_helper", "--nocapture"]).env(HELPER, "1");
    let mut helper = spawn(helper.stdin(Stdio::null()).stdout(Stdio::piped()), AMPLE).expect("it starts");
    let mut pipe = BufReader::new(helper.stdout.take().expect("piped"));
    let mut folder = PathBuf::new();
    loop {
        match first_line(&mut pipe) {
            line if line == "ready\n" => return (helper, pipe, folder),
            line if line.is_empty() => panic!("it ended too early"),
            line => folder = line.strip_prefix("folder ").map_or(folder, |path| path.trim_end().into()),
        }
    }
}

/// Not a test of its own: the process that the tests above interrupt.
#[test]
fn interrupted_helper() {
    if std::env::var_os(HELPER).is_some() {
        on_interrupt(|| println!("hook"));
        let folder = tempfile::tempdir().expect("there is room for it");
        remove_on_interrupt(folder.path());
        println!("\nfolder {}", folder.path().display());
        let mut child = spawn(shell(FAMILY).stdout(Stdio::inherit()), AMPLE).expect("it starts");
        child.wait().expect("it ends");
    }
}
