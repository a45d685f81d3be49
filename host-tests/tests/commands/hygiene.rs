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

/// The project's crates: their folders, and the names that they have as dependencies.
const FOLDERS: [&str; 8] = [
    "",
    "kernel",
    "firmware",
    "host-tests",
    "host-tests/cycles",
    "host-tests/peers",
    "host-tests/reference",
    "host-tests/vectors",
];
const OWN: [&str; 6] = ["cycles", "double-pendulum-kernel", "firmware", "host-tests", "reference", "vectors"];

/// The names in a manifest's tables of dependencies, this project's own crates apart.
fn dependencies(manifest: &str) -> BTreeSet<String> {
    let tables = manifest.split("\n[").filter_map(|table| table.split_once("dependencies]\n"));
    let lines = tables.flat_map(|(_, rows)| rows.lines()).filter(|line| !line.starts_with(['#', ' ']));
    let names = lines.filter_map(|line| Some(line.split_once(['.', ' ', '='])?.0.to_owned()));
    names.filter(|name| !OWN.contains(&&**name)).collect()
}

#[test]
fn every_dependency_has_its_reason() {
    let manifests = FOLDERS.map(|folder| read(Path::new(folder).join("Cargo.toml")));
    let named: BTreeSet<_> = manifests.iter().flat_map(|manifest| dependencies(manifest)).collect();
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
