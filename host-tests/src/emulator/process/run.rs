//! Running a child to its end with its output captured.

use std::io::{BufRead, BufReader, Read};
use std::process::{Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::{Duration, Instant};

use super::{ProcessError, spawn};

/// How often the watcher is told that the child is alive.
const TICK: Duration = Duration::from_millis(100);
/// How long the output may still come in after the child has ended.
const DRAIN: Duration = Duration::from_secs(1);

/// What a child said and how it ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Output {
    /// How it ended.
    pub status: ExitStatus,
    /// Its standard output; bytes that are not UTF-8 are replaced.
    pub stdout: String,
    /// Its standard error; bytes that are not UTF-8 are replaced.
    pub stderr: String,
}

/// Runs `command` to its end, captured, without input; at the latest after `limit` it is ended.
pub fn run(command: &mut Command, limit: Duration) -> Result<Output, ProcessError> {
    run_watched(command, limit, |_| {})
}

/// As [`run`]; meanwhile `watch` is called with each line of either output, and with `None` at least ten times a second
/// while there is none: the child is alive.
pub fn run_watched(
    command: &mut Command,
    limit: Duration,
    mut watch: impl FnMut(Option<&str>),
) -> Result<Output, ProcessError> {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = spawn(command, limit)?;
    let (sender, lines) = mpsc::channel();
    forward(child.stdout.take(), Stream::Out, sender.clone());
    forward(child.stderr.take(), Stream::Err, sender);

    let (mut stdout, mut stderr) = (String::new(), String::new());
    let mut ended = None;
    loop {
        match lines.recv_timeout(TICK) {
            Ok((stream, line)) => {
                watch(Some(line.trim_end()));
                match stream {
                    Stream::Out => stdout.push_str(&line),
                    Stream::Err => stderr.push_str(&line),
                }
            }
            Err(RecvTimeoutError::Timeout) => watch(None),
            Err(RecvTimeoutError::Disconnected) => break,
        }
        if ended.is_none() {
            ended = child.try_wait()?.map(|status| (status, Instant::now()));
        }
        // A stranger that left the group may hold the pipes open; it does not hold us up.
        if ended.is_some_and(|(_, at)| at.elapsed() > DRAIN) {
            break;
        }
    }
    let status = match ended {
        Some((status, _)) => status,
        None => child.wait()?,
    };
    Ok(Output { status, stdout, stderr })
}

#[derive(Clone, Copy)]
enum Stream {
    Out,
    Err,
}

/// Sends each line of `source` on, until its end or until nobody listens.
fn forward(source: Option<impl Read + Send + 'static>, stream: Stream, lines: Sender<(Stream, String)>) {
    let Some(source) = source else { return };
    thread::spawn(move || {
        let mut source = BufReader::new(source);
        let mut line = Vec::new();
        while source.read_until(b'\n', &mut line).is_ok_and(|count| count > 0) {
            if lines.send((stream, String::from_utf8_lossy(&line).into_owned())).is_err() {
                return;
            }
            line.clear();
        }
    });
}
