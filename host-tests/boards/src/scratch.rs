//! Temporary folders of emulators. A folder that a killed command has left is removed when a later
//! command makes one.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use nix::fcntl::{Flock, FlockArg};
use tempfile::TempDir;

use super::process::remove_on_interrupt;

const PREFIX: &str = "double-pendulum-run-";
/// The age by which a folder has been locked by its owner.
const LOCKED_BY_THEN: Duration = Duration::from_secs(60);

/// A temporary folder of this process.
#[derive(Debug)]
pub struct Scratch {
    folder: TempDir,
    /// The lock is released when this process ends, for any reason.
    _lock: Flock<File>,
}

impl Scratch {
    pub fn new() -> io::Result<Self> {
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir()?;
        remove_on_interrupt(folder.path());

        let opened = File::open(folder.path())?;
        let lock = Flock::lock(opened, FlockArg::LockExclusiveNonblock);
        let lock = lock.map_err(|(_, error)| error)?;

        for abandoned in abandoned(folder.path().parent()) {
            let _ = fs::remove_dir_all(abandoned);
        }
        Ok(Self {
            folder,
            _lock: lock,
        })
    }

    pub fn path(&self) -> &Path {
        self.folder.path()
    }
}

fn abandoned(parent: Option<&Path>) -> Vec<PathBuf> {
    let entries = parent.and_then(|folder| fs::read_dir(folder).ok());
    let is_ours = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default();
        name.as_encoded_bytes().starts_with(PREFIX.as_bytes())
    };

    let paths = entries.into_iter().flatten().flatten();
    paths
        .map(|entry| entry.path())
        .filter(is_ours)
        .filter(|path| is_abandoned(path).unwrap_or(false))
        .collect()
}

fn is_abandoned(path: &Path) -> io::Result<bool> {
    let folder = File::open(path)?;
    let metadata = folder.metadata()?;
    let age = SystemTime::now().duration_since(metadata.modified()?);
    // The owner of a new folder may not have locked it yet.
    if !metadata.is_dir() || age.is_ok_and(|age| age < LOCKED_BY_THEN) {
        return Ok(false);
    }
    Ok(Flock::lock(folder, FlockArg::LockExclusiveNonblock).is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn old(parent: &Path, name: &str) -> PathBuf {
        let path = parent.join(name);
        fs::create_dir(&path).expect("a folder");
        let long_ago = SystemTime::now() - 2 * LOCKED_BY_THEN;
        let opened = File::open(&path).expect("a folder");
        opened.set_modified(long_ago).expect("its time");
        path
    }

    #[test]
    fn only_old_folders_without_an_owner_are_abandoned() {
        let parent = tempfile::tempdir().expect("a folder");
        let parent = parent.path();
        let left = old(parent, "double-pendulum-run-left");
        let owned = old(parent, "double-pendulum-run-owned");
        old(parent, "another");
        fs::create_dir(parent.join("double-pendulum-run-new")).expect("a folder");

        let opened = File::open(owned).expect("a folder");
        let lock = Flock::lock(opened, FlockArg::LockExclusiveNonblock).expect("a lock");
        assert_eq!(abandoned(Some(parent)), [left]);
        drop(lock);
        assert_eq!(abandoned(Some(parent)).len(), 2);
    }
}
