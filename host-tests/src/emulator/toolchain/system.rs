//! The world outside, as far as the set-up needs it.

use std::env;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::console::progress::Progress;
use crate::emulator::process::{Output, ProcessError, run, run_watched};

/// What the set-up may ask of the system.
pub(super) trait System {
    /// Runs a command to its end, within the limit; if `doing` is given, it is shown meanwhile.
    fn run(&self, command: &mut Command, limit: Duration, doing: Option<&str>) -> Result<Output, ProcessError>;
    /// The program that would be run by this name.
    fn find(&self, program: &str) -> Option<PathBuf>;
    /// The names in a folder; none if there is no such folder.
    fn list(&self, folder: &Path) -> Vec<String>;
    /// Whether packages may be installed.
    fn is_root(&self) -> bool;
}

/// The system this runs on.
#[derive(Debug)]
pub(super) struct Host;

impl System for Host {
    fn run(&self, command: &mut Command, limit: Duration, doing: Option<&str>) -> Result<Output, ProcessError> {
        match doing {
            Some(doing) => {
                let mut progress = Progress::start(doing);
                run_watched(command, limit, |line| progress.alive(line))
            }
            None => run(command, limit),
        }
    }

    fn find(&self, program: &str) -> Option<PathBuf> {
        let folders = env::var_os("PATH")?;
        env::split_paths(&folders).map(|folder| folder.join(program)).find(|path| is_executable(path))
    }

    fn list(&self, folder: &Path) -> Vec<String> {
        let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
        entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    }

    fn is_root(&self) -> bool {
        nix::unistd::geteuid().is_root()
    }
}

fn is_executable(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|file| file.is_file() && file.permissions().mode() & 0o111 != 0)
}
