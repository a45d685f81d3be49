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

fn output(child: &mut Running) -> BufReader<ChildStdout> {
    BufReader::new(child.stdout.take().expect("piped"))
}

fn line(pipe: &mut BufReader<ChildStdout>) -> String {
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
fn much_output_and_the_exit_code_are_captured_while_a_watcher_sees_lines_and_silence() {
    let script =
        "i=0; while [ $i -lt 20000 ]; do echo 0123456789; echo 0123456789 >&2; i=$((i+1)); done; sleep 1; exit 7";
    let (mut lines, mut ticks) = (0, 0);
    let output = run_watched(&mut shell(script), AMPLE, |line| match line {
        Some(_) => lines += 1,
        None => ticks += 1,
    });
    let output = output.expect("it runs");
    assert_eq!((output.stdout.len(), output.stderr.len(), output.status.code()), (220_000, 220_000, Some(7)));
    assert!(lines == 40_000 && ticks > 0, "{lines} lines, {ticks} ticks");
}

#[test]
fn a_missing_program_is_named() {
    let error = run(&mut Command::new("no-such-program"), AMPLE).expect_err("it does not exist");
    assert!(error.to_string().starts_with("cannot run no-such-program: "), "{error}");
}

#[test]
fn the_time_limit_ends_the_whole_group_waited_for_or_not_and_willing_or_not() {
    for script in [FAMILY.to_owned(), format!("trap '' TERM; {FAMILY}")] {
        let mut child = spawn(&mut shell(&script), SHORT).expect("it starts");
        assert_eq!(rest(output(&mut child)), "ready\n");
        assert!(matches!(child.wait(), Err(ProcessError::TimedOut(_, SHORT))));
    }
}

#[test]
fn letting_go_ends_the_whole_group() {
    let mut child = spawn(&mut shell(FAMILY), AMPLE).expect("it starts");
    let mut pipe = output(&mut child);
    assert_eq!(line(&mut pipe), "ready\n");
    drop(child);
    assert_eq!(rest(pipe), "");
}

#[test]
fn what_an_ended_child_leaves_behind_is_ended() {
    let output = run(&mut shell("(sleep 20; echo survived) & echo done"), AMPLE).expect("it runs");
    assert_eq!((output.stdout.as_str(), output.status.code()), ("done\n", Some(0)));
}

#[test]
fn children_end_with_an_interrupted_or_killed_process() {
    for (signal, code, said) in [
        (Signal::SIGINT, Some(130), "hook\n"),
        (Signal::SIGTERM, Some(143), "hook\n"),
        (Signal::SIGHUP, Some(129), "hook\n"),
        (Signal::SIGKILL, None, ""),
    ] {
        let (mut helper, pipe, folder) = helper();
        kill(Pid::from_raw(helper.id() as i32), signal).expect("it runs");
        assert_eq!(rest(pipe), said, "{signal}");
        assert_eq!(helper.wait().expect("it ends").code(), code, "{signal}");
        assert_eq!(folder.exists(), code.is_none(), "{signal}: {}", folder.display());
        // Gone already, but after a kill.
        let _ = std::fs::remove_dir_all(folder);
    }
}

/// The process to interrupt, its output after its family is ready, and its folder.
fn helper() -> (Running, BufReader<ChildStdout>, PathBuf) {
    let mut helper = Command::new(std::env::current_exe().expect("a test has a path"));
    helper.args(["--exact", "process::interrupted_helper", "--nocapture"]).env(HELPER, "1");
    let mut helper = spawn(helper.stdin(Stdio::null()).stdout(Stdio::piped()), AMPLE).expect("it starts");
    let mut pipe = output(&mut helper);
    let mut folder = PathBuf::new();
    loop {
        match line(&mut pipe) {
            line if line == "ready\n" => return (helper, pipe, folder),
            line if line.is_empty() => panic!("it ended too early"),
            line => folder = line.strip_prefix("folder ").map_or(folder, |path| path.trim_end().into()),
        }
    }
}

/// Not a test of its own: the process that the test above interrupts.
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
