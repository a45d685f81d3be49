//! Supervised child processes: each has a time limit and its own process group, and the whole group is killed when its owner
//! lets go of it, when the time is up, and when this process ends, interrupted (Ctrl-C, SIGTERM, SIGHUP) or killed.
//!
//! A shell in the group, the warden, does it. Groups within groups end too, for each has a warden of its own.

use std::io::{self, BufRead, BufReader, Read};
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::Path;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitCode, ExitStatus, Stdio, exit};
use std::sync::atomic::AtomicUsize;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGHUP, SIGINT, SIGKILL, SIGTERM};
use signal_hook::flag::register_usize;
use signal_hook::iterator::Signals;

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
    let child = command.process_group(warden.id().cast_signed()).spawn();
    let mut child = child.map_err(failed).inspect_err(|_| end(&mut warden))?;
    let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    Ok(Running { child, warden, program, started, limit, stdin, stdout, stderr })
}

/// Kills what is left of the group: waiting for the warden closes its input, and it kills the group.
fn end(warden: &mut Child) {
    let _ = warden.wait();
}

impl Running {
    pub fn id(&self) -> u32 {
        self.child.id()
    }

    /// Waits for the child's end. What is left of its group is killed. If it was killed at its time limit, the error's kind says so.
    pub fn wait(&mut self) -> io::Result<ExitStatus> {
        let status = self.child.wait()?;
        end(&mut self.warden);
        let is_stopped = status.signal() == Some(SIGKILL) && self.started.elapsed() >= self.limit;
        if is_stopped { Err(timed_out(&self.program, self.limit)) } else { Ok(status) }
    }

    /// The child's exit status if it has ended, without waiting.
    pub fn try_wait(&mut self) -> io::Result<Option<ExitStatus>> {
        self.child.try_wait()?.map(|_| self.wait()).transpose()
    }
}

/// The error of a program that was stopped at its time limit.
pub fn timed_out(program: &str, limit: Duration) -> io::Error {
    let seconds = limit.as_secs_f32();
    io::Error::new(io::ErrorKind::TimedOut, format!("{program} was still running after {seconds} s and was stopped"))
}

impl Drop for Running {
    fn drop(&mut self) {
        end(&mut self.warden);
        // Should the warden be gone.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A child's exit status as our own; failure if it was ended by a signal.
pub fn exit_code(status: ExitStatus) -> ExitCode {
    status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from)
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

/// As [`run`]; meanwhile `watch` is called with each line of either output, and with `None` at least ten times a second
/// while there is none: the child is alive.
pub fn run_watched(command: &mut Command, limit: Duration, mut watch: impl FnMut(Option<&str>)) -> io::Result<Output> {
    const TICK: Duration = Duration::from_millis(100);
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

/// The signals that interrupt a command: Ctrl-C, a request to end, a terminal that is closed.
const INTERRUPTS: [i32; 3] = [SIGINT, SIGTERM, SIGHUP];

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
        let Ok(mut signals) = Signals::new(INTERRUPTS) else { return };
        thread::spawn(move || {
            let Some(signal) = signals.forever().next() else { return };
            hooks().drain(..).for_each(|hook| hook());
            exit(128 + signal);
        });
    });
    hooks().push(Box::new(hook));
}

/// An interrupt takes this folder away too, which no value is dropped for.
pub fn remove_on_interrupt(folder: &Path) {
    let folder = folder.to_owned();
    // It may be gone already.
    on_interrupt(move || drop(std::fs::remove_dir_all(folder)));
}
