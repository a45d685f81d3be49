//! Supervised child processes: each has a time limit and its own process group, and the whole group is gone when its
//! owner lets go of it, when the time is up, when this process is interrupted (Ctrl-C, SIGTERM, SIGHUP), and when it is killed.
//!
//! A group is first asked to stop (SIGTERM), so that a child which supervises children of its own can end those too;
//! what is left after a short grace is killed.

mod registry;
mod run;

pub use registry::{INTERRUPTS, interrupted_by, on_interrupt, remove_on_interrupt};
pub use run::{Output, run, run_watched};

use std::io;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitCode, ExitStatus};
use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use registry::Group;

/// How often a child is asked whether it has ended.
const POLL: Duration = Duration::from_millis(5);

/// Why a child could not be run to its end.
#[derive(Debug, thiserror::Error)]
pub enum ProcessError {
    /// The program does not exist or may not be run.
    #[error("cannot start {program}: {source}")]
    NotStarted {
        /// The program, as it was called.
        program: String,
        /// The system's reason.
        source: io::Error,
    },
    /// The time limit passed; the child and its group were ended.
    #[error("{program} was still running after {} s and was stopped", limit.as_secs_f32())]
    TimedOut {
        /// The program, as it was called.
        program: String,
        /// The limit it was given.
        limit: Duration,
    },
    /// The system could not say how the child ended.
    #[error("lost track of {program}: {source}")]
    Lost {
        /// The program, as it was called.
        program: String,
        /// The system's reason.
        source: io::Error,
    },
}

/// A running child. Dropping it ends its whole process group.
#[derive(Debug)]
pub struct Running {
    group: Arc<Group>,
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
    let (group, mut child_pipes) =
        registry::start(command, limit).map_err(|source| ProcessError::NotStarted { program, source })?;
    Ok(Running {
        group,
        stdin: child_pipes.stdin.take(),
        stdout: child_pipes.stdout.take(),
        stderr: child_pipes.stderr.take(),
    })
}

impl Running {
    /// The child's process id.
    pub fn id(&self) -> u32 {
        self.group.id()
    }

    /// Waits for the child's end. What is left of its group is ended too.
    pub fn wait(&mut self) -> Result<ExitStatus, ProcessError> {
        loop {
            if let Some(status) = self.try_wait()? {
                return Ok(status);
            }
            sleep(POLL);
        }
    }

    /// The child's exit status if it has ended, without waiting.
    pub fn try_wait(&mut self) -> Result<Option<ExitStatus>, ProcessError> {
        let status = self
            .group
            .try_wait()
            .map_err(|source| ProcessError::Lost { program: self.group.program().to_owned(), source })?;
        if status.is_some() {
            registry::finish(&self.group);
            if self.group.timed_out() {
                let program = self.group.program().to_owned();
                return Err(ProcessError::TimedOut { program, limit: self.group.limit() });
            }
        }
        Ok(status)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        registry::finish(&self.group);
    }
}

/// A child's exit status as our own; failure if it was ended by a signal.
pub fn exit_code(status: ExitStatus) -> ExitCode {
    status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from)
}

/// The pipes of a child that has just been started.
struct Pipes {
    stdin: Option<ChildStdin>,
    stdout: Option<ChildStdout>,
    stderr: Option<ChildStderr>,
}

impl Pipes {
    fn of(child: &mut Child) -> Self {
        Self { stdin: child.stdin.take(), stdout: child.stdout.take(), stderr: child.stderr.take() }
    }
}
