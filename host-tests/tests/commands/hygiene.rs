//! What the project is made of: every dependency has its reason. That `unsafe` stands where the hardware is reached, `unsafe_code`
//! sees to, and that each of its blocks says why it is sound, `clippy::undocumented_unsafe_blocks`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use host_tests::emulator::toolchain::workspace;

/// The paths of the sources in a folder of the project.
pub fn sources(folder: &str) -> Vec<PathBuf> {
    let folder = workspace().join(folder);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let paths = entries.map(|entry| entry.unwrap_or_else(|error| panic!("{error}")).path());
    let within = |path: PathBuf| if path.is_dir() { sources(&path.to_string_lossy()) } else { vec![path] };
    paths.flat_map(within).filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// The text of a file of the project.
pub fn read(file: impl AsRef<Path>) -> String {
    let file = workspace().join(file);
    fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

/// The names in a manifest's tables of dependencies, this project's own crates apart.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let mut within = false;
    let mut names = BTreeSet::new();
    for line in manifest.lines() {
        if line.starts_with('[') {
            within = line.ends_with("dependencies]");
        } else if within && let Some((name, _)) = line.split_once(['.', ' ', '=']) {
            names.insert(name.to_owned());
        }
    }
    for own in ["cycles", "double-pendulum-kernel", "firmware", "host-tests", "reference", "vectors", "#", ""] {
        names.remove(own);
    }
    names
}

#[test]
fn every_dependency_has_its_reason() {
    let own = ["cycles/", "peers/", "reference/", "vectors/"].map(|folder| format!("host-tests/{folder}"));
    let folders = ["", "kernel/", "firmware/", "host-tests/"].into_iter().chain(own.each_ref().map(|own| &**own));
    let named: BTreeSet<_> = folders.flat_map(|folder| dependencies(&read(format!("{folder}Cargo.toml")))).collect();
    let table = read(".ci/dependencies.md");
    let rows = table.lines().filter_map(|line| Some(line.strip_prefix("| `")?.split_once('`')?.0.to_owned()));
    assert_eq!(named, rows.collect());
}

/// No more lines of the kernel's examples, nor names that each imports from it.
const LINES: usize = 25;
const NAMES: usize = 6;

#[test]
fn the_kernels_examples_are_short() {
    let examples = sources("kernel/examples");
    assert!(examples.len() >= 5);
    for path in examples {
        let example = read(&path);
        let imports = example.lines().filter_map(|line| line.strip_prefix("use double_pendulum::"));
        let names: usize = imports.map(|names| names.rsplit("::").next().unwrap_or_default().split(',').count()).sum();
        let lines = example.lines().count();
        assert!(lines <= LINES && (1..=NAMES).contains(&names), "{}: {lines} lines, {names} names", path.display());
    }
}
