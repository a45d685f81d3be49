//! Supervised child processes. Each has a time limit and its own process group.
//!
//! The whole group is killed when its [`Running`] is dropped, when the time is up, and when this
//! process ends: normally, interrupted (Ctrl-C, SIGQUIT, SIGTERM, SIGHUP) or killed.
//!
//! A shell in the group, the warden, kills the group. Nested groups end too, because each has its
//! own warden.

use std::io::{self, ErrorKind};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, Command, ExitCode, ExitStatus, Stdio, exit};
use std::sync::atomic::{AtomicBool, AtomicUsize};
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use signal_hook::consts::{SIGCONT, SIGHUP, SIGINT, SIGKILL, SIGQUIT, SIGTERM};
use signal_hook::flag::{register, register_usize};
use signal_hook::iterator::Signals;

use super::stream::{Stream, wait};

/// The program of the warden.
///
/// It kills the group when the time is up, and when the other end of its input is closed. Only this
/// process has the other end, so it is closed when this process ends for any reason. This works on
/// any Unix and reaches the children's children.
const WARDEN: &str = "(sleep $0; kill -KILL 0) & read -r _; kill -KILL 0";

#[derive(Debug)]
pub struct Running {
    pub child: Child,
    /// Waiting for the warden closes its input, and the warden then kills the rest of the group.
    warden: Child,
    program: String,
    started: Instant,
    limit: Duration,
}

/// Starts `command` in its own process group, with a warden run by `sh`. A child in the background
/// must not read the terminal.
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

    // The warden starts before the child, and its process ID becomes the ID of the group.
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
    /// Waits until the child ends, and kills the rest of its group. `TimedOut` means that it was
    /// killed at its time limit.
    pub fn wait(&mut self) -> io::Result<ExitStatus> {
        let status = self.child.wait()?;
        let _ = self.warden.wait();

        // The warden kills with SIGKILL. Before the time limit somebody else did.
        let is_stopped = status.signal() == Some(SIGKILL) && self.started.elapsed() >= self.limit;
        let program = &self.program;
        let seconds = self.limit.as_secs_f32();
        let late = || format!("{program} was still running after {seconds} s and was stopped");
        if is_stopped {
            Err(io::Error::new(ErrorKind::TimedOut, late()))
        } else {
            Ok(status)
        }
    }

    pub fn try_wait(&mut self) -> io::Result<Option<ExitStatus>> {
        self.child.try_wait()?.map(|_| self.wait()).transpose()
    }

    /// Returns the exit status. A child without an open stream is about to end and is waited for.
    pub fn ended(&mut self, streams: &[Stream]) -> io::Result<Option<ExitStatus>> {
        if streams.iter().any(|stream| stream.is_open) {
            self.try_wait()
        } else {
            self.wait().map(Some)
        }
    }

    pub fn streams(&mut self) -> io::Result<[Stream; 2]> {
        let pipes = self.child.stdout.take().zip(self.child.stderr.take());
        let (stdout, stderr) = pipes.ok_or_else(|| io::Error::other("a child without pipes"))?;
        Ok([Stream::of(stdout)?, Stream::of(stderr)?])
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.warden.wait();

        // This is for the case that the warden itself was killed.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

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

pub fn run(command: &mut Command, limit: Duration) -> io::Result<Output> {
    run_watched(command, limit, |_| {})
}

/// Passes the last line of new output to `watch`, or `None` about ten times a second while nothing
/// arrives.
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
        // A process that has left the group can hold the pipes open for longer.
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

        // The outputs were read after the end was noticed, so nothing is missing.
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

const INTERRUPTS: [i32; 4] = [SIGINT, SIGQUIT, SIGTERM, SIGHUP];

/// Returns the shell's exit code for a command ended by this signal.
pub fn interrupted_by(signal: usize) -> ExitCode {
    ExitCode::from(if signal == 0 { 0 } else { 128 + signal as u8 })
}

/// Returns a variable for the number of the signal that interrupts this process. The process then
/// continues instead of ending, unless [`on_interrupt`] is called, too.
pub fn interrupted() -> io::Result<Arc<AtomicUsize>> {
    let signal = Arc::default();
    for each in INTERRUPTS {
        register_usize(each, Arc::clone(&signal), each as usize)?;
    }
    Ok(signal)
}

/// Runs `hook` when this process is interrupted, before it exits, to restore things such as the
/// terminal's mode. A hook must not block, panic or add a hook: the process would not exit.
pub fn on_interrupt(hook: impl FnOnce() + Send + 'static) {
    type Hook = Box<dyn FnOnce() + Send>;
    static HOOKS: Mutex<Vec<Hook>> = Mutex::new(Vec::new());
    static HANDLER: Once = Once::new();

    // A panic elsewhere must not prevent a hook from running, so a poisoned lock is accepted.
    let hooks = || HOOKS.lock().unwrap_or_else(PoisonError::into_inner);
    HANDLER.call_once(|| {
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

/// Removes this file or folder when this process is interrupted, because values are not dropped
/// then.
pub fn remove_on_interrupt(path: &Path) {
    let path = path.to_owned();

    on_interrupt(move || {
        drop(std::fs::remove_file(&path).or_else(|_| std::fs::remove_dir_all(path)))
    });
}

pub fn suspend() -> io::Result<()> {
    Ok(kill(Pid::from_raw(0), Signal::SIGTSTP)?)
}

pub fn continued() -> io::Result<Arc<AtomicBool>> {
    let continued = Arc::default();
    register(SIGCONT, Arc::clone(&continued))?;
    Ok(continued)
}
