//! Set-ups take turns.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::thread::sleep;
use std::time::{Duration, Instant};

use nix::errno::Errno;
use nix::fcntl::{Flock, FlockArg};

use super::error::SetupError;
use crate::console::progress::Progress;

/// As long as another set-up can take.
const LIMIT: Duration = Duration::from_secs(3600);
/// How often to ask.
const POLL: Duration = Duration::from_millis(100);

/// Our turn; it ends when this is dropped or the process ends, however it ends.
#[derive(Debug)]
pub(super) struct Lock(#[expect(dead_code, reason = "held, never read")] Flock<File>);

impl Lock {
    /// Waits for our turn at the file.
    pub(super) fn take(path: &Path) -> Result<Self, SetupError> {
        let refuse = |reason: io::Error| SetupError::of(format!("cannot lock {}: {reason}", path.display()));
        let mut file = open(path).map_err(refuse)?;
        let mut waiting = None;
        let started = Instant::now();
        loop {
            match Flock::lock(file, FlockArg::LockExclusiveNonblock) {
                Ok(lock) => return Ok(Self(lock)),
                Err((returned, Errno::EWOULDBLOCK)) if started.elapsed() < LIMIT => file = returned,
                Err((_, error)) => return Err(refuse(error.into())),
            }
            waiting.get_or_insert_with(|| Progress::start("waiting for another set-up")).alive(None);
            sleep(POLL);
        }
    }
}

fn open(path: &Path) -> io::Result<File> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    File::options().create(true).truncate(false).write(true).open(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_ups_take_turns() {
        let path = std::env::temp_dir().join(format!("double-pendulum-lock-{}", std::process::id()));
        let first = Lock::take(&path).unwrap();
        let busy = std::sync::atomic::AtomicBool::new(true);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                let _second = Lock::take(&path).unwrap();
                assert!(!busy.load(std::sync::atomic::Ordering::SeqCst), "two turns at once");
            });
            sleep(3 * POLL);
            busy.store(false, std::sync::atomic::Ordering::SeqCst);
            drop(first);
        });
        fs::remove_file(path).unwrap();
    }

    #[test]
    fn a_lock_that_cannot_be_had_is_named() {
        let error = Lock::take(Path::new("/dev/null/setup.lock")).unwrap_err();
        assert!(error.to_string().starts_with("cannot set up: cannot lock /dev/null/setup.lock: "), "{error}");
    }
}
