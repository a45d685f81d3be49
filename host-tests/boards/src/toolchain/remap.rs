//! Compiler flags that remove the builder's folders from the firmware's images, so that the same
//! commit has the same bytes on any machine and in any folder.
//!
//! Panic messages contain the names of source files. The files of other crates are in cargo's
//! folder, and the files of the core library may be in the compiler's folder. Both are usually in
//! the builder's home. The flags replace them by names that do not depend on the machine.

use std::path::{Path, PathBuf, absolute};
use std::process::Command;
use std::{env, fs};

use super::run::quick_output;
use super::{target, workspace};

/// If several prefixes match, the compiler uses the last one, so the order matters.
pub(super) fn flags() -> Result<Vec<String>, String> {
    let mut renamed = vec![
        (workspace().to_owned(), ".".to_owned()),
        (target(), "target".to_owned()),
    ];

    // A mirror of the registry has a folder with another name, so the folder's name is replaced,
    // too.
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
    renamed.push(core_library()?);

    // The compiler may name a folder behind a link by the link or by its target.
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

fn cargo_home() -> Option<PathBuf> {
    let set = env::var_os("CARGO_HOME").filter(|folder| !folder.is_empty());
    set.and_then(|folder| absolute(folder).ok())
        .or_else(|| Some(Path::new(&env::var_os("HOME")?).join(".cargo")))
}

/// Returns the folder of the core library's sources, and its name in the ready-made core library.
fn core_library() -> Result<(PathBuf, String), String> {
    let output = |arguments: &[&str]| {
        let mut command = Command::new("rustc");
        command.args(arguments).current_dir(workspace());
        quick_output(command.env("RUSTUP_AUTO_INSTALL", "0"))
    };
    let sysroot = output(&["--print", "sysroot"])?;
    let version = output(&["--version", "--verbose"])?;
    let entry = |name: &str| version.lines().find_map(|line| line.strip_prefix(name));

    // A compiler of a distribution has no commit hash.
    let commit = entry("commit-hash: ").filter(|commit| *commit != "unknown");
    let name = commit.or(entry("release: ")).unwrap_or_default();
    Ok((
        Path::new(sysroot.trim()).join("lib/rustlib/src/rust"),
        format!("/rustc/{name}"),
    ))
}
