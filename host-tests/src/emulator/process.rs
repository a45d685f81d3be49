//! Supervised child processes: each has a time limit and its own process group, and the whole group is killed when its owner
//! lets go of it, when the time is up, and when this process ends, interrupted (Ctrl-C, SIGTERM, SIGHUP) or killed.
//!
//! A shell in the group, the warden, does it. Groups within groups end too, for each has a warden of its own.

mod interrupt;
mod run;

pub use interrupt::{interrupted, interrupted_by, on_interrupt, remove_on_interrupt};
pub use run::{Output, run, run_watched};

use std::io;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitCode, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use nix::sys::signal::{Signal, killpg};
use nix::unistd::Pid;

/// Kills the group when the time is up, and when the other end of its input closes, which this process alone has: when this
/// process ends, by any signal. Any Unix can do that, and it reaches the children's children.
const WARDEN: &str = "(sleep $0; kill -KILL 0) & read -r _; kill -KILL 0";

/// A running child. Dropping it kills its whole process group.
#[derive(Debug)]
pub struct Running {
    child: Child,
    warden: Child,
    program: String,
    started: Instant,
    limit: Duration,
    /// How it ended, and whether too late.
    ended: Option<(ExitStatus, bool)>,
    pub stdin: Option<ChildStdin>,
    pub stdout: Option<ChildStdout>,
    pub stderr: Option<ChildStderr>,
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
    warden.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    // Is in the group from before the child, and gives it its number.
    let mut warden = warden.process_group(0).spawn().map_err(failed)?;
    let mut child = command.process_group(warden.id().cast_signed()).spawn().map_err(|error| {
        end(&mut warden);
        failed(error)
    })?;
    let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    Ok(Running { child, warden, program, started, limit, ended: None, stdin, stdout, stderr })
}

/// Kills what is left of the warden's group, which keeps its number until the warden has been waited for.
fn end(warden: &mut Child) {
    // Fails if the group is gone.
    let _ = killpg(Pid::from_raw(warden.id().cast_signed()), Signal::SIGKILL);
    let _ = warden.wait();
}

impl Running {
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Waits for the child's end. What is left of its group is killed. If it was killed at its time limit, the error's kind says so.
    pub fn wait(&mut self) -> io::Result<ExitStatus> {
        let status = self.child.wait();
        self.end(status?)
    }

    /// The child's exit status if it has ended, without waiting.
    pub fn try_wait(&mut self) -> io::Result<Option<ExitStatus>> {
        self.child.try_wait()?.map(|status| self.end(status)).transpose()
    }

    fn end(&mut self, status: ExitStatus) -> io::Result<ExitStatus> {
        let Self { warden, program, started, limit, ended, .. } = self;
        let (status, is_stopped) = *ended.get_or_insert_with(|| {
            let is_late = started.elapsed() >= *limit;
            end(warden);
            (status, is_late && status.signal() == Some(Signal::SIGKILL as i32))
        });
        if is_stopped { Err(timed_out(program, *limit)) } else { Ok(status) }
    }
}

/// The error of a program that was stopped at its time limit.
pub fn timed_out(program: &str, limit: Duration) -> io::Error {
    let seconds = limit.as_secs_f32();
    io::Error::new(io::ErrorKind::TimedOut, format!("{program} was still running after {seconds} s and was stopped"))
}

impl Drop for Running {
    fn drop(&mut self) {
        if self.ended.is_none() {
            end(&mut self.warden);
            let _ = self.child.wait();
        }
    }
}

/// A child's exit status as our own; failure if it was ended by a signal.
pub fn exit_code(status: ExitStatus) -> ExitCode {
    status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from)
}
