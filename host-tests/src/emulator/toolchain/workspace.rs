//! Where the project is, and where what it builds goes: found as a command runs, for a checkout may be moved or copied with its
//! programs already built.

use std::env;
use std::path::{Path, PathBuf, absolute};
use std::process::exit;
use std::sync::OnceLock;

use crate::console::cli::{REFUSED, complain};

/// What the workspace alone has, and no folder above or beside it.
const MARKS: [&str; 3] = ["kernel/Cargo.toml", "firmware/Cargo.toml", "host-tests/Cargo.toml"];

/// The workspace's folder: above the package that cargo runs, else above the current folder, else above this program.
/// Where there is none the process ends as any command does that cannot be served: one line, exit code 2.
pub fn workspace() -> &'static Path {
    static FOUND: OnceLock<PathBuf> = OnceLock::new();
    FOUND.get_or_init(|| {
        let run_by_cargo = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
        let starts = [run_by_cargo, env::current_dir().ok(), env::current_exe().ok()];
        starts.into_iter().flatten().find_map(|start| above(&start)).unwrap_or_else(|| {
            complain("error: the project's folder is neither above this one nor above the program: run it from there");
            exit(REFUSED.into())
        })
    })
}

/// The workspace that `start` is in.
fn above(start: &Path) -> Option<PathBuf> {
    let is_it = |folder: &&Path| MARKS.iter().all(|mark| folder.join(mark).is_file());
    start.ancestors().find(is_it).map(Path::to_owned)
}

/// Where everything built goes: `CARGO_TARGET_DIR`, as cargo has it, or else the workspace's own folder.
pub fn target() -> PathBuf {
    let chosen = env::var_os("CARGO_TARGET_DIR").filter(|folder| !folder.is_empty());
    chosen.and_then(|folder| absolute(folder).ok()).unwrap_or_else(|| workspace().join("target"))
}
