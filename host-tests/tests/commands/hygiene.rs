//! The dependencies of the project, each with its reason. The lint `unsafe_code` checks that
//! `unsafe` is used for hardware access only, and `clippy::undocumented_unsafe_blocks` that each
//! block has its reason.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use emulator::toolchain::workspace;
use serde_json::Value;

use super::cli::output;

/// Returns the paths of the sources in a folder of the project.
pub fn sources(folder: &str) -> Vec<PathBuf> {
    let folder = workspace().join(folder);
    let entries =
        fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let paths = entries.map(|entry| entry.unwrap_or_else(|error| panic!("{error}")).path());
    let within = |path: PathBuf| {
        if path.is_dir() {
            sources(&path.to_string_lossy())
        } else {
            vec![path]
        }
    };
    paths
        .flat_map(within)
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect()
}

/// Returns the text of a file of the project.
pub fn read(file: impl AsRef<Path>) -> String {
    let file = workspace().join(file);
    fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// The table in `.ci/dependencies.md` names exactly the crates of a registry that the workspace
/// depends on directly.
#[test]
fn every_dependency_has_its_reason() {
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args([
            "metadata",
            "--no-deps",
            "--offline",
            "--format-version",
            "1",
        ])
        .current_dir(workspace());
    let metadata: Value = serde_json::from_str(&output(&mut cargo).stdout).expect("JSON");
    let all = |list: &Value| list.as_array().cloned().unwrap_or_default();
    let direct = all(&metadata["packages"])
        .into_iter()
        .flat_map(|package| all(&package["dependencies"]));

    // The project's own crates come from no registry.
    let named = direct
        .filter(|one| !one["source"].is_null())
        .filter_map(|one| Some(one["name"].as_str()?.to_owned()));

    // The table names each dependency once.
    let table = read(".ci/dependencies.md");
    let rows = table
        .lines()
        .filter_map(|line| Some(line.strip_prefix("| `")?.split_once('`')?.0.to_owned()));
    assert_eq!(named.collect::<BTreeSet<_>>(), rows.collect());
}

/// Returns the crates of a lock file, each as its name and version.
fn locked(file: &str) -> BTreeSet<String> {
    let text = read(file);
    let crates = text.split("[[package]]\n").skip(1);
    crates
        .map(|lines| lines.lines().take(2).collect::<Vec<_>>().join(", "))
        .collect()
}

/// The crate outside of the workspace has a lock file of its own. It names the same versions, so
/// that nothing else has to be fetched. To follow the workspace, change `kernel/minimal/Cargo.lock`
/// by `cargo update --manifest-path kernel/minimal/Cargo.toml --package NAME --precise VERSION`.
#[test]
fn the_minimal_programs_have_the_versions_of_the_workspace() {
    let others = &locked("kernel/minimal/Cargo.lock") - &locked("Cargo.lock");
    let own: Vec<_> = others.iter().map(String::as_str).collect();
    assert_eq!(own, ["name = \"minimal\", version = \"0.0.0\""]);
}

/// The largest number of lines of a kernel example, a page, and of names that it imports.
const LINES: usize = 50;
const NAMES: usize = 6;

/// There are at least five examples. Each has at most [`LINES`] lines and imports 1 to [`NAMES`]
/// names from the kernel.
#[test]
fn the_kernels_examples_are_short() {
    let examples = sources("kernel/examples");
    assert!(examples.len() >= 5);
    for path in examples {
        let example = read(&path);
        // The names that the example imports from the kernel.
        let imports = example
            .lines()
            .filter_map(|line| line.strip_prefix("use double_pendulum::"));
        let names: usize = imports
            .map(|names| {
                names
                    .rsplit("::")
                    .next()
                    .unwrap_or_default()
                    .split(',')
                    .count()
            })
            .sum();
        let lines = example.lines().count();
        assert!(
            lines <= LINES && (1..=NAMES).contains(&names),
            "{}: {lines} lines, {names} names",
            path.display()
        );
    }
}
