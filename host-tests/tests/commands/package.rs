//! The kernel as its users get it: its package in an empty crate, with the dependency and the first example of its README.

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use host_tests::emulator::process::{self, Output};
use host_tests::emulator::toolchain::workspace;

/// A guard against hanging: many times what cargo takes, on a slow and busy machine too.
const LIMIT: Duration = Duration::from_secs(600);

/// Runs a program in a folder.
fn run(program: &str, arguments: &[&str], folder: &Path) -> Output {
    process::run(Command::new(program).args(arguments).current_dir(folder), LIMIT)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Runs cargo with what is on this machine, and only if that is not enough with the registry.
fn cargo(arguments: &[&str], folder: &Path) {
    if !run(env!("CARGO"), &[arguments, &["--offline"]].concat(), folder).status.success() {
        let output = run(env!("CARGO"), arguments, folder);
        assert!(output.status.success(), "cargo {arguments:?}: {}", output.stderr);
    }
}

/// The first block of `kind` in a page.
fn block<'a>(page: &'a str, kind: &str) -> &'a str {
    let blocks = page.split_once(&format!("```{kind}\n")).and_then(|(_, rest)| rest.split_once("```"));
    blocks.unwrap_or_else(|| panic!("no block of {kind}")).0
}

#[test]
fn the_readmes_example_runs_in_an_empty_crate() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let target = folder.path().join("target");
    let target = target.to_str().expect("a path that is text");
    let package = ["package", "--package", "double-pendulum-kernel", "--allow-dirty", "--no-verify", "--target-dir"];
    cargo(&[&package[..], &[target]].concat(), workspace());

    let name = concat!("double-pendulum-kernel-", env!("CARGO_PKG_VERSION"));
    let unpacked = run("tar", &["-xf", &format!("{target}/package/{name}.crate")], folder.path());
    assert!(unpacked.status.success(), "{}", unpacked.stderr);

    let readme = fs::read_to_string(folder.path().join(name).join("README.md")).expect("the package has its README");
    let (before, path) = block(&readme, "toml").split_once("path = \"").expect("a path while on no registry");
    let (_, after) = path.split_once('"').expect("it ends");
    let empty = folder.path().join("empty");
    fs::create_dir_all(empty.join("src")).expect("a temporary folder can be written to");
    let manifest =
        format!("[workspace]\n[package]\nname = \"empty\"\nedition = \"2024\"\n{before}path = \"../{name}\"{after}");
    fs::write(empty.join("Cargo.toml"), manifest).expect("likewise");
    fs::write(empty.join("src/main.rs"), block(&readme, "rust")).expect("likewise");
    cargo(&["run", "--target-dir", target], &empty);
}
