//! Supervised child processes: each has a time limit and its own process group, and the whole group
//! is killed when its owner lets go of it, when the time is up, and when this process ends,
//! interrupted (Ctrl-C, SIGQUIT, SIGTERM, SIGHUP) or killed.
//!
//! A shell in the group, the warden, does it. Groups within groups end too, for each has a warden of its own.

use std::io::{self, ErrorKind};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command, ExitCode, ExitStatus, Stdio, exit};
use std::sync::atomic::AtomicUsize;
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGHUP, SIGINT, SIGKILL, SIGQUIT, SIGTERM};
use signal_hook::flag::register_usize;
use signal_hook::iterator::Signals;

use super::stream::{Stream, wait};

/// Kills the group when the time is up, and when the other end of its input closes, which this process alone has: when this
/// process ends, by any signal. Any Unix can do that, and it reaches the children's children.
const WARDEN: &str = "(sleep $0; kill -KILL 0) & read -r _; kill -KILL 0";

/// A running child. Dropping it kills its whole process group.
#[derive(Debug)]
pub struct Running {
    pub child: Child,
    /// Waiting for it closes its input, and it kills what is left of the group.
    warden: Child,
    program: String,
    started: Instant,
    limit: Duration,
}

/// Starts `command` in a process group of its own, to be killed at the latest after `limit`, waited for or not.
///
/// A child in the background must not read the terminal, so give it `Stdio::null()` or a pipe as its standard input.
pub fn spawn(command: &mut Command, limit: Duration) -> io::Result<Running> {
    let program = command.get_program().to_string_lossy().into_owned();
    let failed = |error: io::Error| io::Error::other(format!("cannot run {program}: {error}"));
    let started = Instant::now();
    let mut warden = Command::new("sh");
    warden.args(["-c", WARDEN, &limit.as_secs_f64().to_string()]);
    warden
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    // Is in the group from before the child, and gives it its number.
    let mut warden = warden.process_group(0).spawn().map_err(failed)?;
    let child = command.process_group(warden.id().cast_signed()).spawn();
    let child = child.map_err(failed).inspect_err(|_| drop(warden.wait()))?;
    Ok(Running {
        child,
        warden,
        program,
        started,
        limit,
    })
}

impl Running {
    /// Waits for the child's end. What is left of its group is killed. If it was killed at its time limit, the error's kind says so.
    pub fn wait(&mut self) -> io::Result<ExitStatus> {
        let status = self.child.wait()?;
        let _ = self.warden.wait();
        let is_stopped = status.signal() == Some(SIGKILL) && self.started.elapsed() >= self.limit;
        let (program, seconds) = (&self.program, self.limit.as_secs_f32());
        let late = || format!("{program} was still running after {seconds} s and was stopped");
        if is_stopped {
            Err(io::Error::new(ErrorKind::TimedOut, late()))
        } else {
            Ok(status)
        }
    }

    /// The child's exit status if it has ended, without waiting.
    pub fn try_wait(&mut self) -> io::Result<Option<ExitStatus>> {
        self.child.try_wait()?.map(|_| self.wait()).transpose()
    }

    /// As [`Self::try_wait`]; but if these [`streams`](Self::streams) have ended, the child's end is near, and waited for.
    pub fn ended(&mut self, streams: &[Stream]) -> io::Result<Option<ExitStatus>> {
        if streams.iter().any(|stream| stream.is_open) {
            self.try_wait()
        } else {
            self.wait().map(Some)
        }
    }

    /// Both outputs, which are pipes.
    pub fn streams(&mut self) -> io::Result<[Stream; 2]> {
        let pipes = self.child.stdout.take().zip(self.child.stderr.take());
        let (stdout, stderr) = pipes.ok_or_else(|| io::Error::other("a child without pipes"))?;
        Ok([Stream::of(stdout)?, Stream::of(stderr)?])
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.warden.wait();
        // Should the warden be gone.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A child's exit status as our own; failure if it was ended by a signal.
pub fn exit_code(status: ExitStatus) -> ExitCode {
    status
        .code()
        .and_then(|code| u8::try_from(code).ok())
        .map_or(ExitCode::FAILURE, ExitCode::from)
}

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

/// As [`run`]; meanwhile `watch` is called with the last line that has come, and with `None` at least ten times a second while
/// there is none: the child is alive.
pub fn run_watched(
    command: &mut Command,
    limit: Duration,
    mut watch: impl FnMut(Option<&str>),
) -> io::Result<Output> {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = spawn(command, limit)?;
    let mut streams = child.streams()?;
    loop {
        // Whoever has left the group may hold the pipes open for longer.
        let ended = child.ended(&streams)?;
        let new = streams
            .iter_mut()
            .map(Stream::take_in)
            .filter(|new| !new.is_empty())
            .last();
        watch(
            new.map(String::from_utf8_lossy)
                .as_deref()
                .and_then(|text| text.lines().last()),
        );
        if let Some(status) = ended {
            let [stdout, stderr] =
                streams.map(|stream| String::from_utf8_lossy(&stream.bytes).into_owned());
            return Ok(Output {
                status,
                stdout,
                stderr,
            });
        }
        wait(streams.iter());
    }
}

/// The signals that interrupt a command: Ctrl-C, Ctrl-\, a request to end, a terminal that is
/// closed.
const INTERRUPTS: [i32; 4] = [SIGINT, SIGQUIT, SIGTERM, SIGHUP];

/// The exit code that the shell has for a command ended by a signal, 130 after Ctrl-C; success for 0, which is none.
pub fn interrupted_by(signal: usize) -> ExitCode {
    ExitCode::from(if signal == 0 { 0 } else { 128 + signal as u8 })
}

/// The signal that has interrupted this process since, 0 as long as none has; it goes on meanwhile.
pub fn interrupted() -> io::Result<Arc<AtomicUsize>> {
    let signal = Arc::default();
    for each in INTERRUPTS {
        register_usize(each, Arc::clone(&signal), each as usize)?;
    }
    Ok(signal)
}

/// Runs `hook` when this process is interrupted, before it exits: for what must be put back, such as the terminal's mode.
pub fn on_interrupt(hook: impl FnOnce() + Send + 'static) {
    type Hook = Box<dyn FnOnce() + Send>;
    static HOOKS: Mutex<Vec<Hook>> = Mutex::new(Vec::new());
    static HANDLER: Once = Once::new();
    // A panic elsewhere must not keep a hook from running, so a poisoned lock is as good as any.
    let hooks = || HOOKS.lock().unwrap_or_else(PoisonError::into_inner);
    HANDLER.call_once(|| {
        // Fails only for signals that no program may handle.
        let Ok(mut signals) = Signals::new(INTERRUPTS) else {
            return;
        };
        thread::spawn(move || {
            let Some(signal) = signals.forever().next() else {
                return;
            };
            hooks().drain(..).for_each(|hook| hook());
            exit(128 + signal);
        });
    });
    hooks().push(Box::new(hook));
}

/// Removes this file or folder when this process is interrupted, for then no value is dropped.
pub fn remove_on_interrupt(path: &Path) {
    let path = path.to_owned();
    // It may be gone already.
    on_interrupt(move || {
        drop(std::fs::remove_file(&path).or_else(|_| std::fs::remove_dir_all(path)))
    });
}
