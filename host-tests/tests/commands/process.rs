//! Supervised child processes end when they should. A test detects the end of a process by a pipe
//! that the process inherited: the pipe ends when its last holder has ended. A process that
//! outlives its owner writes "late" first.

use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::process::{ChildStdout, Command, Stdio};
use std::time::Duration;

use emulator::process::{Running, on_interrupt, remove_on_interrupt, run, run_watched, spawn};
use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;

/// A limit far above the time that any of these children needs.
const AMPLE: Duration = Duration::from_secs(60);
/// The limit of children that must be stopped.
const SHORT: Duration = Duration::from_secs(2);
/// A process with a child of its own. Both ignore requests to end.
const FAMILY: &str = "trap '' TERM; (sleep 20; echo late) & echo ready; sleep 20; echo late";
/// The environment variable that turns [`interrupted_helper`] from an empty test into the process
/// to interrupt.
const HELPER: &str = "PROCESS_TEST_HELPER";

/// Returns a command that runs this script, with its output in a pipe.
fn shell(script: &str) -> Command {
    let mut command = Command::new("sh");
    command
        .args(["-c", script])
        .stdin(Stdio::null())
        .stdout(Stdio::piped());
    command
}

/// Takes the output of a child.
fn output(child: &mut Running) -> BufReader<ChildStdout> {
    BufReader::new(child.child.stdout.take().expect("piped"))
}

/// Returns everything up to the end of the pipe.
fn rest(mut pipe: BufReader<ChildStdout>) -> String {
    let mut text = String::new();
    pipe.read_to_string(&mut text)
        .expect("the pipe can be read");
    text
}

/// A child writes 220,000 bytes to each output, is silent for two seconds and ends with code 7. All
/// of that is captured, and the watcher was called with lines and, more than five times, without. A
/// program that does not exist is an error with its name.
#[test]
fn output_and_exit_code_are_captured_while_a_watcher_sees_lines_and_silence() {
    let script = "i=0; while [ $i -lt 20000 ]; do echo 0123456789; echo 0123456789 >&2; \
        i=$((i+1)); done; sleep 2; exit 7";
    // The watcher sees some of the lines, and the silence at the end.
    let mut lines = 0;
    let mut ticks = 0;
    let watch = |line: Option<&str>| match line {
        Some(line) => lines += usize::from(line == "0123456789"),
        None => ticks += 1,
    };
    let output = run_watched(&mut shell(script), AMPLE, watch).expect("it runs");
    assert_eq!(
        (
            output.stdout.len(),
            output.stderr.len(),
            output.status.code()
        ),
        (220_000, 220_000, Some(7))
    );
    assert!(lines > 0 && ticks > 5, "{lines} lines, {ticks} ticks");

    // A program that does not exist is an error with its name.
    let error = run(&mut Command::new("no-such-program"), AMPLE).expect_err("it does not exist");
    assert!(
        error
            .to_string()
            .starts_with("cannot run no-such-program: "),
        "{error}"
    );
}

/// A process and its child, which ignore requests to end, end before they write "late": at the time
/// limit, which is an error; when their owner is dropped; and when the first process ends.
#[test]
fn the_whole_group_ends_with_its_time_its_owner_or_its_leader() {
    // The time limit ends the group.
    let mut late = spawn(&mut shell(FAMILY), SHORT).expect("it starts");
    assert_eq!(rest(output(&mut late)), "ready\n");
    assert_eq!(
        late.wait().expect_err("its time is up").kind(),
        ErrorKind::TimedOut
    );

    // The end of its owner ends the group.
    let mut dropped = spawn(&mut shell(FAMILY), AMPLE).expect("it starts");
    let mut pipe = output(&mut dropped);
    pipe.read_line(&mut String::new()).expect("it is ready");
    drop(dropped);
    assert_eq!(rest(pipe), "");

    // The end of the first process of the group ends the others.
    let ended = run(&mut shell("(sleep 20; echo late) & echo done"), AMPLE).expect("it runs");
    assert_eq!(
        (ended.stdout.as_str(), ended.status.code()),
        ("done\n", Some(0))
    );
}

/// A process with a child, a hook and a folder is ended by each of five signals. Its child ends
/// too. After an interrupt the hook has run, the folder is gone, and the exit code is 128 plus the
/// signal; after SIGKILL none of these.
#[test]
fn children_end_with_an_interrupted_or_killed_process() {
    for (signal, code, said) in [
        (Signal::SIGINT, Some(130), "hook\n"),
        (Signal::SIGTERM, Some(143), "hook\n"),
        (Signal::SIGHUP, Some(129), "hook\n"),
        (Signal::SIGQUIT, Some(131), "hook\n"),
        (Signal::SIGKILL, None, ""),
    ] {
        // A process that has registered a hook and a folder, and has a child.
        let folder = tempfile::tempdir().expect("there is room for it");
        let mut helper = Command::new(std::env::current_exe().expect("a test has a path"));
        helper
            .args(["--exact", "process::interrupted_helper", "--nocapture"])
            .env(HELPER, folder.path());
        let mut helper =
            spawn(helper.stdin(Stdio::null()).stdout(Stdio::piped()), AMPLE).expect("it starts");
        let mut pipe = output(&mut helper);
        let mut line = String::new();
        while !line.ends_with("ready\n") {
            line.clear();
            assert_ne!(
                pipe.read_line(&mut line).expect("the pipe can be read"),
                0,
                "it ended too early"
            );
        }
        // The hook has run and the folder is gone, unless the process was killed.
        kill(Pid::from_raw(helper.child.id().cast_signed()), signal).expect("it runs");
        assert_eq!(rest(pipe), said, "{signal}");
        assert_eq!(helper.wait().expect("it ends").code(), code, "{signal}");
        assert_eq!(folder.path().exists(), code.is_none(), "{signal}");
    }
}

/// The process that the test above interrupts. As a test it does nothing.
#[test]
fn interrupted_helper() {
    if let Some(folder) = std::env::var_os(HELPER) {
        on_interrupt(|| println!("hook"));
        remove_on_interrupt(folder.as_ref());
        let mut child = spawn(shell(FAMILY).stdout(Stdio::inherit()), AMPLE).expect("it starts");
        child.wait().expect("it ends");
    }
}
