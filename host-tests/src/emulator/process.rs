//! Supervised child processes: each has a time limit and its own process group, and the whole group is gone when its
//! owner lets go of it, when the time is up, and when this process ends, interrupted (Ctrl-C, SIGTERM, SIGHUP) or killed.
//!
//! A group is first asked to stop (SIGTERM), so that a child which supervises children of its own can end those too;
//! what is left after a short grace is killed. Two look after it: a thread, its keeper, and for the time when this process
//! is no more a shell in the group, its warden.

mod interrupt;
mod run;

pub use interrupt::{INTERRUPTS, interrupted_by, on_interrupt, remove_on_interrupt};
pub use run::{Output, run, run_watched};

use std::convert::Infallible;
use std::io;
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitCode, ExitStatus, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, OnceLock};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use nix::sys::signal::{Signal, killpg};
use nix::unistd::Pid;

/// How often a keeper looks at its child.
const POLL: Duration = Duration::from_millis(5);
/// How long a group may take to stop when asked, before it is killed.
const GRACE: Duration = Duration::from_secs(2);
/// Reads a pipe whose other end this process alone has: it ends when this process does, by whatever signal. Any Unix can do
/// that, and it reaches the children's children, which the parent-death signal of Linux does not.
const WARDEN: &str = "read -r _; trap '' TERM; kill -TERM 0; kill -CONT 0; sleep 1; kill -KILL 0";

/// Why a child could not be run to its end.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProcessError {
    /// The program, as it was called, does not exist or may not be run; the system's reason.
    #[error("cannot run {0}: {1}")]
    Failed(String, String),
    /// The time limit passed; the child and its group were ended.
    #[error("{0} was still running after {seconds} s and was stopped", seconds = .1.as_secs_f32())]
    TimedOut(String, Duration),
}

/// A running child. Dropping it ends its whole process group.
#[derive(Debug)]
pub struct Running {
    id: u32,
    ended: Arc<OnceLock<Result<ExitStatus, ProcessError>>>,
    /// The keeper ends the group when this is dropped.
    owner: Option<Sender<Infallible>>,
    /// The child's standard input, where the command asked for a pipe.
    pub stdin: Option<ChildStdin>,
    /// The child's standard output, where the command asked for a pipe.
    pub stdout: Option<ChildStdout>,
    /// The child's standard error, where the command asked for a pipe.
    pub stderr: Option<ChildStderr>,
}

/// Starts `command` in a process group of its own, to be ended at the latest after `limit`.
///
/// The limit holds whether or not anybody waits. A child in the background must not read the terminal, so give it
/// `Stdio::null()` or a pipe as its standard input.
pub fn spawn(command: &mut Command, limit: Duration) -> Result<Running, ProcessError> {
    let program = command.get_program().to_string_lossy().into_owned();
    let failed = |error: io::Error| ProcessError::Failed(program.clone(), error.to_string());
    // Is in the group from before the child, and gives it its number.
    let mut warden = Command::new("sh");
    warden.args(["-c", WARDEN]).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut warden = warden.process_group(0).spawn().map_err(failed)?;
    let mut child = match command.process_group(warden.id().cast_signed()).spawn() {
        Ok(child) => child,
        Err(error) => {
            let _ = warden.kill().and_then(|()| warden.wait());
            return Err(failed(error));
        }
    };
    let (owner, let_go) = mpsc::channel();
    let (id, ended) = (child.id(), Arc::default());
    let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    let running = Running { id, ended: Arc::clone(&ended), owner: Some(owner), stdin, stdout, stderr };
    thread::spawn(move || {
        let is_late = wait(&mut child, limit, &let_go);
        end(&mut child, &mut warden);
        let status = child.wait().map_err(|error| ProcessError::Failed(program.clone(), error.to_string()));
        let _ = ended.set(if is_late { Err(ProcessError::TimedOut(program, limit)) } else { status });
    });
    Ok(running)
}

/// Waits for the child's end or until its owner lets go of it; whether its time is up before that.
fn wait(child: &mut Child, limit: Duration, let_go: &Receiver<Infallible>) -> bool {
    let started = Instant::now();
    while matches!(child.try_wait(), Ok(None)) {
        if started.elapsed() >= limit {
            return true;
        }
        if let_go.recv_timeout(POLL) == Err(RecvTimeoutError::Disconnected) {
            break;
        }
    }
    false
}

/// Ends what is left of the group.
fn end(child: &mut Child, warden: &mut Child) {
    let group = Pid::from_raw(warden.id().cast_signed());
    let asked = Instant::now();
    let _ = killpg(group, Signal::SIGTERM).and_then(|()| killpg(group, Signal::SIGCONT));
    loop {
        // The two that are ours are of the group until they have been waited for.
        let _ = (child.try_wait(), warden.try_wait());
        if killpg(group, None).is_err() {
            return;
        }
        if asked.elapsed() >= GRACE {
            let _ = killpg(group, Signal::SIGKILL);
            let _ = warden.wait();
            return;
        }
        sleep(POLL);
    }
}

impl Running {
    /// The child's process id.
    pub fn id(&self) -> u32 {
        self.id
    }

    /// Waits for the child's end. What is left of its group is ended too.
    pub fn wait(&mut self) -> Result<ExitStatus, ProcessError> {
        self.ended.wait().clone()
    }

    /// The child's exit status if it has ended, without waiting.
    pub fn try_wait(&mut self) -> Result<Option<ExitStatus>, ProcessError> {
        self.ended.get().cloned().transpose()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.owner = None;
        self.ended.wait();
    }
}

/// A child's exit status as our own; failure if it was ended by a signal.
pub fn exit_code(status: ExitStatus) -> ExitCode {
    status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from)
}
