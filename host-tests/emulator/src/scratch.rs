//! Temporary folders of emulators. A folder that a killed command has left is removed when a later
//! command makes one.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use nix::fcntl::{Flock, FlockArg};
use tempfile::TempDir;

use super::process::remove_on_interrupt;

/// The prefix of the folders' names. No other files have it.
const PREFIX: &str = "double-pendulum-run-";
/// The age after which a folder has been locked by its owner. An older folder without a lock is
/// abandoned.
const LOCKED_BY_THEN: Duration = Duration::from_secs(60);

/// A temporary folder of this process. It is removed when this is dropped and when the process is
/// interrupted.
///
/// A folder that a killed process has left is removed by the next process that makes a `Scratch` in
/// the same directory, if the last change of the folder was at least 60 s ago.
#[derive(Debug)]
pub struct Scratch {
    folder: TempDir,
    /// The lock is released when this process ends, for any reason.
    _lock: Flock<File>,
}

impl Scratch {
    /// Makes a folder in the system's directory for temporary files (`TMPDIR`, or else `/tmp`), and
    /// removes old folders of killed processes there, if it can. An error means that the folder
    /// cannot be made or locked. From now on an interrupt ends the process
    /// ([`remove_on_interrupt`]).
    pub fn new() -> io::Result<Self> {
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir()?;
        remove_on_interrupt(folder.path());

        let opened = File::open(folder.path())?;
        let lock = Flock::lock(opened, FlockArg::LockExclusiveNonblock);
        let lock = lock.map_err(|(_, error)| error)?;

        // Folders without an owner remain after a command was killed.
        for abandoned in abandoned(folder.path().parent()) {
            // Another process may remove the same folder at the same time.
            let _ = fs::remove_dir_all(abandoned);
        }
        Ok(Self {
            folder,
            _lock: lock,
        })
    }

    /// Returns the absolute path of the folder.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

/// Returns the folders in the directory `parent` whose owners have ended.
fn abandoned(parent: Option<&Path>) -> Vec<PathBuf> {
    let entries = parent.and_then(|folder| fs::read_dir(folder).ok());
    let is_ours = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default();
        name.as_encoded_bytes().starts_with(PREFIX.as_bytes())
    };

    // A folder that cannot be inspected counts as in use.
    let paths = entries.into_iter().flatten().flatten();
    paths
        .map(|entry| entry.path())
        .filter(is_ours)
        .filter(|path| is_abandoned(path).unwrap_or(false))
        .collect()
}

/// Returns true if this is a folder that is old enough and not locked.
fn is_abandoned(path: &Path) -> io::Result<bool> {
    let folder = File::open(path)?;
    let metadata = folder.metadata()?;
    let age = SystemTime::now().duration_since(metadata.modified()?);
    // The owner of a new folder may not have locked it yet.
    if !metadata.is_dir() || age.is_ok_and(|age| age < LOCKED_BY_THEN) {
        return Ok(false);
    }
    // A folder that can be locked has no owner.
    Ok(Flock::lock(folder, FlockArg::LockExclusiveNonblock).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Makes an old folder in the directory `parent`, as a killed command leaves it.
    fn old(parent: &Path, name: &str) -> PathBuf {
        let path = parent.join(name);
        fs::create_dir(&path).expect("a folder");
        let long_ago = SystemTime::now() - 2 * LOCKED_BY_THEN;
        let opened = File::open(&path).expect("a folder");
        opened.set_modified(long_ago).expect("its time");
        path
    }

    /// An old folder that is not locked is abandoned. An old one with a lock, a
    /// new one, and one with another name are not. The locked one is abandoned once its lock is
    /// released.
    #[test]
    fn only_old_folders_without_an_owner_are_abandoned() {
        let parent = tempfile::tempdir().expect("a folder");
        let parent = parent.path();
        let left = old(parent, "double-pendulum-run-left");
        let owned = old(parent, "double-pendulum-run-owned");
        old(parent, "another");
        fs::create_dir(parent.join("double-pendulum-run-new")).expect("a folder");

        // Hold the lock of one folder as its owner does, and release it later.
        let opened = File::open(owned).expect("a folder");
        let lock = Flock::lock(opened, FlockArg::LockExclusiveNonblock).expect("a lock");
        assert_eq!(abandoned(Some(parent)), [left]);
        drop(lock);
        assert_eq!(abandoned(Some(parent)).len(), 2);
    }
}
