//! Running a child to its end with its output captured.

use std::io::{self, BufRead, BufReader, Read};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use super::spawn;

/// How often the watcher is told that the child is alive.
const TICK: Duration = Duration::from_millis(100);

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    pub status: ExitStatus,
    pub stdout: String,
    pub stderr: String,
}

/// Runs `command` to its end, captured, without input; at the latest after `limit` it is killed.
pub fn run(command: &mut Command, limit: Duration) -> io::Result<Output> {
    run_watched(command, limit, |_| {})
}

/// As [`run`]; meanwhile `watch` is called with each line of either output, and with `None` at least ten times a second
/// while there is none: the child is alive.
pub fn run_watched(command: &mut Command, limit: Duration, mut watch: impl FnMut(Option<&str>)) -> io::Result<Output> {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = spawn(command, limit)?;
    let (sender, lines) = mpsc::channel();
    forward(0, child.stdout.take(), sender.clone());
    forward(1, child.stderr.take(), sender);
    let mut said = [String::new(), String::new()];
    let mut has_ended = false;
    loop {
        match lines.recv_timeout(TICK) {
            Ok((stream, line)) => {
                watch(Some(line.trim_end()));
                said[stream].push_str(&line);
            }
            // A process that has left the group may hold the pipes open.
            Err(RecvTimeoutError::Timeout) if has_ended => break,
            Err(RecvTimeoutError::Timeout) => watch(None),
            Err(RecvTimeoutError::Disconnected) => break,
        }
        has_ended = has_ended || child.try_wait()?.is_some();
    }
    let [stdout, stderr] = said;
    Ok(Output { status: child.wait()?, stdout, stderr })
}

/// Sends each line of a numbered stream on, until its end or until no one listens.
fn forward(stream: usize, source: Option<impl Read + Send + 'static>, lines: Sender<(usize, String)>) {
    let Some(source) = source else { return };
    thread::spawn(move || {
        let (mut source, mut line) = (BufReader::new(source), Vec::new());
        while source.read_until(b'\n', &mut line).is_ok_and(|count| count > 0)
            && lines.send((stream, String::from_utf8_lossy(&line).into_owned())).is_ok()
        {
            line.clear();
        }
    });
}
