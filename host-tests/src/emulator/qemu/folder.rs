//! A folder for each machine, in which QEMU finds its sockets and pipes.

use std::io;
use std::os::unix::net::UnixListener;

use tempfile::TempDir;

use crate::emulator::process::remove_on_interrupt;

/// Makes one, removed when it is dropped and when this process is interrupted.
pub(super) fn make() -> io::Result<TempDir> {
    let folder = tempfile::Builder::new().prefix("double-pendulum-").tempdir()?;
    remove_on_interrupt(folder.path());
    Ok(folder)
}

/// Why no machine can have its folder, in one line that names `TMPDIR`: it is no folder, or no socket's name is so long.
pub(crate) fn check() -> Result<(), String> {
    let listened =
        tempfile::tempdir().and_then(|folder| UnixListener::bind(folder.path().join("double-pendulum-debug")));
    let base = std::env::temp_dir();
    listened.map(drop).map_err(|error| format!("QEMU's sockets cannot be in TMPDIR={}: {error}", base.display()))
}
