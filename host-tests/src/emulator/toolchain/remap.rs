//! Flags that keep the builder's folders out of the firmware's images: the same commit has the same
//! bytes wherever it is built.
//!
//! Panics name source files. Files of other crates are in the folder of cargo, and those of the
//! core library may be in that of the compiler: both are usually in the builder's home. The names
//! given instead do not depend on the machine.

use std::path::{Path, PathBuf, absolute};
use std::process::Command;
use std::{env, fs};

use super::bring::says;
use super::{target, workspace};

/// The flags for builds by this compiler. Where several prefixes match, the compiler uses the last.
pub(super) fn flags(rustc: &Path) -> Result<Vec<String>, String> {
    let mut renamed = vec![
        (workspace().to_owned(), ".".to_owned()),
        (target(), "target".to_owned()),
    ];
    // A mirror of the registry has a folder of another name, so the name goes, too.
    let crates = cargo_home().map(|home| home.join("registry/src"));
    let registries = crates.and_then(|folder| fs::read_dir(folder).ok());
    let mut registries: Vec<PathBuf> = registries
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .collect();
    registries.sort();
    renamed.extend(
        registries
            .into_iter()
            .map(|folder| (folder, "crates".to_owned())),
    );
    renamed.push(core_library(rustc)?);

    // The compiler calls a folder behind a link by either name.
    let names = |(from, to): (PathBuf, String)| {
        let real = fs::canonicalize(&from).ok().filter(|real| *real != from);
        [Some(from), real]
            .into_iter()
            .flatten()
            .map(move |from| (from, to.clone()))
    };
    Ok(renamed
        .into_iter()
        .flat_map(names)
        .map(|(from, to)| format!("--remap-path-prefix={}={to}", from.display()))
        .collect())
}

/// Where cargo keeps the sources of other crates.
fn cargo_home() -> Option<PathBuf> {
    let set = env::var_os("CARGO_HOME").filter(|folder| !folder.is_empty());
    set.and_then(|folder| absolute(folder).ok())
        .or_else(|| Some(Path::new(&env::var_os("HOME")?).join(".cargo")))
}

/// The sources of the core library, if they are installed, and the name that the ready-made one has for them.
fn core_library(rustc: &Path) -> Result<(PathBuf, String), String> {
    let said = |arguments: &[&str]| {
        let mut command = Command::new(rustc);
        command.args(arguments).current_dir(workspace());
        says(command.env("RUSTUP_AUTO_INSTALL", "0"))
    };
    let sysroot = said(&["--print", "sysroot"])?;
    let version = said(&["--version", "--verbose"])?;
    let entry = |name: &str| version.lines().find_map(|line| line.strip_prefix(name));
    // A distribution's own compiler knows no commit.
    let commit = entry("commit-hash: ").filter(|commit| *commit != "unknown");
    let name = commit.or(entry("release: ")).unwrap_or_default();
    Ok((
        Path::new(sysroot.trim()).join("lib/rustlib/src/rust"),
        format!("/rustc/{name}"),
    ))
}
