//! Programs that are run to their end. Their failure is a reason in one line.

use std::io;
use std::process::Command;
use std::time::Duration;

use crate::console::progress::Progress;
use crate::process::{Output, run, run_watched};

pub const QUICK: Duration = Duration::from_secs(20);

pub(super) fn attempt(command: &mut Command, limit: Duration, doing: &str) -> Result<(), String> {
    output_or_reason(command, |command| run_shown(command, limit, doing)).map(drop)
}

pub(super) fn run_shown(command: &mut Command, limit: Duration, doing: &str) -> io::Result<Output> {
    let progress = Progress::start(doing);
    run_watched(command, limit, |line| progress.alive(line))
}

pub(super) fn quick_output(command: &mut Command) -> Result<String, String> {
    output_or_reason(command, |command| run(command, QUICK))
}

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
