//! The commands of the README: each is there, and none is taken by one of cargo's own, which nothing can replace.

use std::collections::BTreeSet;
use std::fs;
use std::process::Command;

use host_tests::emulator::toolchain::workspace;

/// Commands that the README names and a user installs.
const INSTALLED: [&str; 1] = ["deny"];

fn read(file: &str) -> String {
    fs::read_to_string(workspace().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// The names of the project's commands.
fn ours() -> BTreeSet<String> {
    let config = read(".cargo/config.toml");
    let aliases = config.lines().skip_while(|line| *line != "[alias]").skip(1).take_while(|line| !line.is_empty());
    aliases.filter_map(|line| Some(line.split_once(" = ")?.0.to_owned())).collect()
}

/// The names of cargo's own commands: what it knows where there is no project and nothing is installed.
fn built_in() -> BTreeSet<String> {
    let nowhere = tempfile::tempdir().expect("a temporary folder");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.arg("--list").current_dir(&nowhere).env("CARGO_HOME", nowhere.path()).env("PATH", "");
    let list = cargo.output().expect("cargo runs").stdout;
    let list = String::from_utf8(list).expect("text");
    list.lines().skip(1).filter_map(|line| Some(line.split_whitespace().next()?.to_owned())).collect()
}

#[test]
fn no_command_is_shadowed() {
    let built_in = built_in();
    assert!(built_in.contains("run"), "{built_in:?}");
    let shadowed: Vec<_> = ours().into_iter().filter(|name| built_in.contains(name)).collect();
    assert!(shadowed.is_empty(), "cargo has its own {shadowed:?}");
}

#[test]
fn the_readme_names_every_command_and_no_other() {
    let readme = read("README.md");
    let words = readme.split("`cargo ").skip(1).chain(readme.split("    cargo ").skip(1));
    let name = |text: &str| text.split(|c: char| !c.is_alphanumeric() && c != '-').next().map(str::to_owned);
    let named: BTreeSet<_> = words.filter_map(name).collect();
    let missing: Vec<_> = ours().into_iter().filter(|command| !named.contains(command)).collect();
    assert!(missing.is_empty(), "not in the README: {missing:?}");
    let known: BTreeSet<_> = ours().into_iter().chain(built_in()).chain(INSTALLED.map(String::from)).collect();
    let unknown: Vec<_> = named.difference(&known).collect();
    assert!(unknown.is_empty(), "in the README alone: {unknown:?}");
}
