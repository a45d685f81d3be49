//! The live process groups of this process, and who looks after them: the guardian thread, which ends those whose time is
//! up; the handler of interrupts, which ends every one of them and then this process; and in each group a shell that kills it
//! when this process has been killed and can do nothing any more.

use std::io;
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, Once, PoisonError};
use std::thread::{self, sleep};
use std::time::{Duration, Instant};

use nix::sys::signal::{Signal, killpg};
use nix::unistd::Pid;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use super::{POLL, Pipes};

/// How long a group may take to stop when asked, before it is killed.
const GRACE: Duration = Duration::from_secs(3);
/// The same when this process is itself interrupted; shorter, so that the one who interrupts need not kill us.
const INTERRUPTED_GRACE: Duration = Duration::from_secs(1);
/// How often the guardian looks at the time limits.
const GUARD: Duration = Duration::from_millis(20);
/// Reads a pipe whose other end this process alone has: it ends when this process does, by whatever signal. Any Unix can do
/// that, no thread must live for it, and it reaches the children's children, which the parent-death signal of Linux does not.
const LAST_WILL: &str = "read -r _; kill -KILL 0";
/// The signals that interrupt a command: Ctrl-C, a request to end, a terminal that is closed.
pub const INTERRUPTS: [i32; 3] = [SIGINT, SIGTERM, SIGHUP];

/// The exit code that the shell has for a command ended by a signal: 130 after Ctrl-C.
pub fn interrupted_by(signal: i32) -> i32 {
    128 + signal
}

static LIVE: Mutex<Vec<Arc<Group>>> = Mutex::new(Vec::new());
static HOOKS: Mutex<Vec<Hook>> = Mutex::new(Vec::new());
static SUPERVISION: Once = Once::new();

type Hook = Box<dyn FnOnce() + Send>;

/// A child and its process group.
#[derive(Debug)]
pub(super) struct Group {
    program: String,
    /// The child's process id.
    pid: u32,
    /// Is in the group from before the child, and gives it its number.
    warden: Mutex<Child>,
    group: Pid,
    started: Instant,
    limit: Duration,
    timed_out: AtomicBool,
    child: Mutex<Child>,
}

impl Group {
    pub(super) fn id(&self) -> u32 {
        self.pid
    }

    pub(super) fn program(&self) -> &str {
        &self.program
    }

    pub(super) fn limit(&self) -> Duration {
        self.limit
    }

    pub(super) fn timed_out(&self) -> bool {
        self.timed_out.load(Ordering::Acquire)
    }

    pub(super) fn try_wait(&self) -> io::Result<Option<ExitStatus>> {
        lock(&self.child).try_wait()
    }

    /// Sends `signal` to every process of the group, or only asks whether there is one; `false` if there is none.
    fn signal(&self, signal: impl Into<Option<Signal>>) -> bool {
        killpg(self.group, signal.into()).is_ok()
    }

    /// Whether any process of the group is left. Reaps the two that are ours.
    fn is_alive(&self) -> bool {
        let child_runs = matches!(self.try_wait(), Ok(None));
        let warden_runs = matches!(lock(&self.warden).try_wait(), Ok(None));
        child_runs || warden_runs || self.signal(None)
    }
}

/// Starts and registers a child.
pub(super) fn start(command: &mut Command, limit: Duration) -> io::Result<(Arc<Group>, Pipes)> {
    SUPERVISION.call_once(supervise);
    let program = command.get_program().to_string_lossy().into_owned();
    // Held while the child starts: an interrupt finds either no child or a registered one.
    let mut live = lock(&LIVE);
    let mut warden = Command::new("sh");
    warden.args(["-c", LAST_WILL]).stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    let mut warden = warden.process_group(0).spawn()?;
    let number = warden.id().cast_signed();
    let mut child = match command.process_group(number).spawn() {
        Ok(child) => child,
        Err(error) => {
            warden.kill().and_then(|()| warden.wait())?;
            return Err(error);
        }
    };
    let pipes = Pipes::of(&mut child);
    let group = Arc::new(Group {
        program,
        pid: child.id(),
        warden: Mutex::new(warden),
        group: Pid::from_raw(number),
        started: Instant::now(),
        limit,
        timed_out: AtomicBool::new(false),
        child: Mutex::new(child),
    });
    live.push(Arc::clone(&group));
    Ok((group, pipes))
}

/// Ends what is left of the group and forgets it.
pub(super) fn finish(group: &Arc<Group>) {
    let registered = |live: &[Arc<Group>]| live.iter().any(|other| Arc::ptr_eq(other, group));
    if registered(&lock(&LIVE)) {
        end(std::slice::from_ref(group), GRACE);
        lock(&LIVE).retain(|other| !Arc::ptr_eq(other, group));
    }
}

/// Runs `hook` when this process is interrupted, after its children have gone and before it exits: for what must be put back,
/// such as the terminal's mode.
pub fn on_interrupt(hook: impl FnOnce() + Send + 'static) {
    SUPERVISION.call_once(supervise);
    lock(&HOOKS).push(Box::new(hook));
}

/// An interrupt takes this folder away too, which no value is dropped for.
pub fn remove_on_interrupt(folder: &Path) {
    let folder = folder.to_owned();
    on_interrupt(move || {
        // It may be gone already.
        let _: io::Result<()> = std::fs::remove_dir_all(folder);
    });
}

/// Asks the groups to stop, and kills those that are still there after `grace`.
fn end(groups: &[Arc<Group>], grace: Duration) {
    let mut left: Vec<_> = groups.iter().filter(|group| group.is_alive()).collect();
    for group in &left {
        group.signal(Signal::SIGTERM);
        group.signal(Signal::SIGCONT);
    }
    let deadline = Instant::now() + grace;
    while !left.is_empty() && Instant::now() < deadline {
        sleep(POLL);
        left.retain(|group| group.is_alive());
    }
    for group in &left {
        group.signal(Signal::SIGKILL);
        // Neither can refuse, so this returns; an error only means that it was already reaped.
        let _ = lock(&group.child).wait();
        let _ = lock(&group.warden).wait();
    }
}

/// Starts the guardian and sets the handler of interrupts; once per process.
fn supervise() {
    thread::spawn(|| {
        loop {
            sleep(GUARD);
            let late: Vec<_> =
                lock(&LIVE).iter().filter(|group| group.started.elapsed() >= group.limit).cloned().collect();
            let late: Vec<_> = late.into_iter().filter(|group| !group.timed_out() && group.is_alive()).collect();
            for group in &late {
                group.timed_out.store(true, Ordering::Release);
            }
            end(&late, GRACE);
        }
    });
    // Fails only for signals that no program may handle.
    let Ok(mut signals) = Signals::new(INTERRUPTS) else { return };
    thread::spawn(move || {
        let Some(signal) = signals.forever().next() else { return };
        // Never released: no child starts from here on.
        let live = lock(&LIVE);
        end(&live, INTERRUPTED_GRACE);
        for hook in lock(&HOOKS).drain(..) {
            hook();
        }
        std::process::exit(interrupted_by(signal));
    });
}

/// A panic elsewhere must not keep children alive, so a poisoned lock is as good as any.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
