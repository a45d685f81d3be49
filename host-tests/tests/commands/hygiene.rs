//! What the project is made of: every dependency has its reason, and `unsafe` stands where the hardware is reached. That each of
//! its blocks says why it is sound, `clippy::undocumented_unsafe_blocks` sees to.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use host_tests::emulator::toolchain::workspace;

/// Where `unsafe` may stand: the boards, the image for cores without one, and a program that overflows its stack to see what
/// becomes of it.
const UNSAFE: [&str; 3] = ["firmware/src/board/", "firmware/cores/", "firmware/src/bin/inject-stack-overflow.rs"];

fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display())) {
        let path = entry.unwrap_or_else(|error| panic!("{error}")).path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn unsafe_code_is_where_it_must_be() {
    let mut files = Vec::new();
    let own = ["host-tests/src", "host-tests/reference/src", "host-tests/vectors/src"];
    for folder in ["kernel/src", "firmware/src", "firmware/cores"].into_iter().chain(own) {
        sources(&workspace().join(folder), &mut files);
    }
    assert!(files.len() > 100, "{} files", files.len());
    for file in files {
        let code = read(&file)
            .lines()
            .map(|line| line.split("//").next().unwrap_or_default().to_owned() + " ")
            .collect::<String>();
        let mut words = code.split(|c: char| !c.is_alphanumeric() && c != '_');
        let name = file.strip_prefix(workspace()).expect("a file of ours").to_string_lossy().into_owned();
        let may = UNSAFE.iter().any(|place| name.starts_with(place));
        assert!(may || !words.any(|word| word == "unsafe"), "{name}");
    }
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
    for own in ["double-pendulum-kernel", "firmware", "host-tests", "reference", "vectors", "#", ""] {
        names.remove(own);
    }
    names
}

#[test]
fn every_dependency_has_its_reason() {
    let own = ["peers/", "reference/", "vectors/"].map(|folder| format!("host-tests/{folder}"));
    let folders = ["", "kernel/", "firmware/", "host-tests/"].into_iter().chain(own.each_ref().map(|own| &**own));
    let manifests = folders.map(|folder| format!("{folder}Cargo.toml"));
    let named: BTreeSet<_> = manifests.flat_map(|manifest| dependencies(&read(&workspace().join(manifest)))).collect();
    let table = read(&workspace().join(".ci/dependencies.md"));
    let rows = table.lines().filter_map(|line| Some(line.strip_prefix("| `")?.split_once('`')?.0.to_owned()));
    assert_eq!(named, rows.collect());
}
