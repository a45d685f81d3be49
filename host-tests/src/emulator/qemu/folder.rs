//! A folder for each machine, in which QEMU finds its sockets and pipes.

use std::fs::{self, File};
use std::io;
use std::os::unix::net::UnixListener;
use std::path::Path;

use nix::fcntl::{Flock, FlockArg};
use tempfile::TempDir;

use crate::emulator::process::remove_on_interrupt;

/// How the names of all folders begin.
const PREFIX: &str = "double-pendulum-";
/// The file that is locked as long as the folder's owner lives, however it ends.
const OWNER: &str = "owner";

/// Why no machine can have its folder, in one line that names `TMPDIR`: it is no folder, or no socket's name is so long.
pub(crate) fn check() -> Result<(), String> {
    let base = std::env::temp_dir();
    let listened = Folder::make_in(&base).and_then(|folder| UnixListener::bind(folder.path().join("debugger")));
    listened.map(drop).map_err(|error| format!("QEMU's sockets cannot be in TMPDIR={}: {error}", base.display()))
}

/// A folder of this process, removed when it is dropped.
#[derive(Debug)]
pub(super) struct Folder {
    folder: TempDir,
    /// Its lock ends with the process.
    _owner: Flock<File>,
}

impl Folder {
    /// Makes one; removes those whose owner was killed before it could do so itself.
    pub(super) fn make() -> io::Result<Self> {
        Self::make_in(&std::env::temp_dir())
    }

    fn make_in(base: &Path) -> io::Result<Self> {
        remove_stale(base);
        let folder = tempfile::Builder::new().prefix(PREFIX).tempdir_in(base)?;
        remove_on_interrupt(folder.path());
        let unnamed = folder.path().join("unlocked");
        let owner = lock(File::create(&unnamed)?).ok_or(io::ErrorKind::WouldBlock)?;
        // Under its name the file has been locked from the first: nobody can take this folder for a stale one.
        fs::rename(unnamed, folder.path().join(OWNER))?;
        Ok(Self { folder, _owner: owner })
    }

    pub(super) fn path(&self) -> &Path {
        self.folder.path()
    }
}

fn lock(file: File) -> Option<Flock<File>> {
    Flock::lock(file, FlockArg::LockExclusiveNonblock).ok()
}

/// A folder that cannot be looked into is somebody else's, and one that cannot be removed is no reason not to go on.
fn remove_stale(base: &Path) {
    for entry in fs::read_dir(base).into_iter().flatten().flatten() {
        let ours = entry.file_name().to_str().is_some_and(|name| name.starts_with(PREFIX));
        let owner = || File::options().write(true).open(entry.path().join(OWNER)).ok();
        if ours && owner().and_then(lock).is_some() {
            let _ = fs::remove_dir_all(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_outlives_its_owner_only_until_the_next_is_made() -> io::Result<()> {
        let base = tempfile::tempdir()?;
        let foreign = base.path().join("double-pendulum-notes");
        fs::create_dir(&foreign)?;
        let live = Folder::make_in(base.path())?;
        let Folder { folder, _owner: owner } = Folder::make_in(base.path())?;
        // As the system does for a killed process: the lock ends, the folder stays.
        let stale = folder.keep();
        drop(owner);

        let next = Folder::make_in(base.path())?;
        assert!(!stale.exists(), "the killed one's folder is gone");
        assert!(live.path().exists() && next.path().exists() && foreign.exists(), "no other is");
        let path = next.path().to_owned();
        drop(next);
        assert!(!path.exists());
        Ok(())
    }
}
