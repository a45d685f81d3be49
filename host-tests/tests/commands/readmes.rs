//! The READMEs name every command, and their links lead to existing files and headings.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use boards::toolchain::workspace;

use super::cli::output;

fn read(file: impl AsRef<Path>) -> String {
    let file = workspace().join(file);
    fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()))
}

const README: [&str; 4] = [
    "README.md",
    "kernel/README.md",
    "firmware/README.md",
    "host-tests/README.md",
];

fn ours() -> BTreeSet<String> {
    let config = read(".cargo/config.toml");
    let aliases = config
        .lines()
        .skip_while(|line| *line != "[alias]")
        .skip(1)
        .take_while(|line| !line.is_empty());
    aliases
        .filter_map(|line| Some(line.split_once(" = ")?.0.to_owned()))
        .collect()
}

fn built_in() -> BTreeSet<String> {
    let nowhere = tempfile::tempdir().expect("a temporary folder");
    let mut cargo = Command::new(env!("CARGO"));
    let list = output(
        cargo
            .arg("--list")
            .current_dir(&nowhere)
            .env("CARGO_HOME", nowhere.path())
            .env("PATH", ""),
    )
    .stdout;
    list.lines()
        .skip(1)
        .filter_map(|line| Some(line.split_whitespace().next()?.to_owned()))
        .collect()
}

fn named(page: &str) -> BTreeSet<String> {
    let words = page
        .split("`cargo ")
        .skip(1)
        .chain(page.split("    cargo ").skip(1));
    let name = |text: &str| {
        text.split(|c: char| !c.is_alphanumeric() && c != '-')
            .next()
            .map(str::to_owned)
    };
    words.filter_map(name).collect()
}

#[test]
fn the_readmes_name_every_command_and_no_other() {
    let named: BTreeSet<_> = README.iter().flat_map(|file| named(&read(file))).collect();
    let known = &ours() | &built_in();
    let [missing, unknown] = [&ours() - &named, &named - &known];
    assert!(
        missing.is_empty() && unknown.is_empty(),
        "in no README: {missing:?}, in READMEs alone: {unknown:?}"
    );
}

#[test]
fn every_link_of_the_readmes_has_its_file() {
    for file in README {
        let page = read(file);
        let folder = workspace()
            .join(file)
            .parent()
            .expect("a folder")
            .to_owned();
        let targets = page
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split([')', '#']).next());
        for target in targets.filter(|target| !target.is_empty() && !target.starts_with("http")) {
            assert!(folder.join(target).exists(), "{file} links to {target}");
        }
    }
}

fn anchors(page: &str) -> BTreeSet<String> {
    let headings = page.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        heading
            .trim_start_matches('#')
            .trim()
            .to_lowercase()
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect()
    };
    headings.map(anchor).collect()
}

#[test]
fn readme_links_to_a_section_name_one_of_its_headings() {
    let mut checked = 0;
    for file in README {
        let page = read(file);
        let folder = Path::new(file).parent().expect("a file has a folder");
        let targets = page
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split_once(')')?.0.split_once('#'))
            .filter(|(target, _)| !target.starts_with("http"));

        for (target, anchor) in targets {
            let linked = match target {
                "" => page.clone(),
                target => read(folder.join(target)),
            };
            assert!(
                anchors(&linked).contains(anchor),
                "{file} links to {target}#{anchor}"
            );
            checked += 1;
        }
    }
    assert!(checked > 20, "{checked} links to sections");
}
