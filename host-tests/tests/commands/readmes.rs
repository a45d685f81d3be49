//! The READMEs: their commands exist, no name is that of one of cargo's own commands, which cannot
//! be replaced, and their links lead to existing files. The kernel's first example works for users,
//! with the package in an empty crate.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

use emulator::toolchain::workspace;

use super::cli::{output, program};
use super::hygiene::read;

/// The first README, and the READMEs of the crates.
const README: [&str; 4] = [
    "README.md",
    "kernel/README.md",
    "firmware/README.md",
    "host-tests/README.md",
];
/// The commands in READMEs that a user installs.
const INSTALLED: [&str; 3] = ["deny", "mutants", "public-api"];

/// Returns the names of the project's commands.
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

/// Every help contains the command's own name, and if it has options, examples that use no other
/// options.
#[test]
fn every_help_has_examples_with_its_own_options_only() {
    for name in ours() {
        let help = output(program(&name).arg("--help")).stdout;
        let usage = help
            .lines()
            .find_map(|line| line.strip_prefix("Usage: cargo "))
            .unwrap_or_default();
        assert_eq!(usage.split_whitespace().next(), Some(&*name), "{help}");

        // The examples use the command's own name and its listed options.
        let (listed, examples) = help.split_once("\nExample").unwrap_or((&help, ""));
        assert!(
            examples.contains(&format!("cargo {name}")) || !usage.contains("[OPTIONS]"),
            "no example of {name}"
        );
        for option in examples
            .split_whitespace()
            .filter(|word| word.starts_with("--"))
        {
            assert!(
                listed.split_whitespace().any(|word| word == option),
                "cargo {name} {option}"
            );
        }
    }
}

/// Returns the names of cargo's own commands, which are available without a project and without any
/// installed command.
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

/// No command of the project has the name of one of cargo's own commands.
#[test]
fn no_command_is_shadowed() {
    let built_in = built_in();
    assert!(
        built_in.contains("run") && ours().is_disjoint(&built_in),
        "{built_in:?}"
    );
}

/// Returns the commands in a page's text: in `backquotes` and in indented blocks.
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

/// Every command of the project is in at least one README. Every command in a README belongs to the
/// project, to cargo, or to [`INSTALLED`].
#[test]
fn the_readmes_name_every_command_and_no_other() {
    let named: BTreeSet<_> = README.iter().flat_map(|file| named(&read(file))).collect();
    let known = &(&ours() | &built_in()) | &INSTALLED.map(String::from).into();
    let [missing, unknown] = [&ours() - &named, &named - &known];
    assert!(
        missing.is_empty() && unknown.is_empty(),
        "in no README: {missing:?}, in READMEs alone: {unknown:?}"
    );
}

/// Every file and folder that a README links to exists.
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

/// Returns the anchors of a page's headings, as GitHub makes them.
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

/// Every link to a section, within a README or in another file, names an existing heading. There
/// are more than 20.
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

        // A target without a file is a heading of the same page.
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

/// The README of the repository has at most 120 lines.
#[test]
fn the_first_readme_is_short() {
    assert!(read(README[0]).lines().count() <= 120);
}

/// The firmware's README lists the messages and the version correctly.
#[test]
fn the_readme_lists_the_messages_as_they_are() {
    let readme = read("firmware/README.md");
    // The table of messages in its section.
    let (_, page) = readme
        .split_once("\n## The serial stream\n")
        .expect("its section");
    let rows = page
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once("` |"));
    let listed: BTreeSet<_> = rows.flat_map(|(names, _)| names.split("`, `")).collect();

    // The variants of the three enums in the source.
    let sources = ["to_host", "command"]
        .map(|file| read(format!("firmware/src/protocol/{file}.rs")))
        .concat();
    let variants = ["ToHost", "Answer", "Command"]
        .into_iter()
        .flat_map(|message| {
            let (_, variants) = sources
                .split_once(&format!("pub enum {message} {{\n"))
                .expect("it is there");
            variants.lines().take_while(|line| *line != "}")
        });
    let names = variants.filter_map(|line| {
        line.strip_prefix("    ")?
            .split(|c: char| !c.is_alphanumeric())
            .next()
    });
    assert_eq!(
        listed,
        names
            .filter(|name| !["", "Answer"].contains(name))
            .collect()
    );
    let version = format!("version is {};", firmware::protocol::VERSION);
    assert!(page.contains(&version), "{version}");
}

/// Runs cargo offline, and with the registry only if that fails.
fn cargo(arguments: &[&str], folder: &Path) {
    let run = |more: &[&str]| {
        output(
            Command::new(env!("CARGO"))
                .args(arguments)
                .args(more)
                .current_dir(folder),
        )
    };
    // The registry is needed only if a package is not on this machine yet.
    if !run(&["--offline"]).status.success() {
        let output = run(&[]);
        assert!(
            output.status.success(),
            "cargo {arguments:?}: {}",
            output.stderr
        );
    }
}

/// Returns the lines of a text that set something: neither empty, nor a comment, nor the name of a
/// table.
fn settings(text: &str) -> impl Iterator<Item = &str> {
    text.lines()
        .map(|line| line.split(" #").next().unwrap_or_default().trim())
        .filter(|line| !line.is_empty() && !line.starts_with(['#', '[']))
}

/// The kernel's README gives its prices with the settings with which the counted programs are
/// compiled, which are also the settings of this repository. There are no others.
#[test]
fn the_kernels_readme_shows_the_settings_of_its_prices() {
    let readme = read("kernel/README.md");
    let (_, page) = readme
        .split_once("\n## What a step costs\n")
        .expect("its section");
    let profile = block(page, "toml");
    let (_, rest) = page.split_once(profile).expect("it is there");
    let flags = block(rest.trim_start_matches("```"), "toml");

    let minimal = read("kernel/minimal/Cargo.toml");
    let (_, minimal) = minimal
        .split_once("[profile.release]\n")
        .expect("a profile");
    let counted: BTreeSet<_> = settings(minimal)
        .filter(|line| !line.starts_with("debug")) // It changes no code.
        .collect();
    assert_eq!(settings(profile).collect::<BTreeSet<_>>(), counted);

    let ours = read("Cargo.toml");
    let (_, ours) = ours.split_once("[profile.release]\n").expect("a profile");
    let ours = ours.split("\n[").next().unwrap_or_default();
    assert!(counted.is_subset(&settings(ours).collect()), "{ours}");

    // The linker's flags are not about speed.
    let config = read("kernel/minimal/.cargo/config.toml");
    let config = config
        .split("[target.'cfg")
        .next()
        .expect("the M4F comes first");
    let shown: Vec<_> = settings(flags).collect();
    assert_eq!(shown, settings(config).collect::<Vec<_>>());
    assert!(read(".cargo/config.toml").contains(shown[0]), "{shown:?}");
}

/// Returns the first block of `kind` in a page.
fn block<'a>(page: &'a str, kind: &str) -> &'a str {
    let blocks = page
        .split_once(&format!("```{kind}\n"))
        .and_then(|(_, rest)| rest.split_once("```"));
    blocks.unwrap_or_else(|| panic!("no block of {kind}")).0
}

/// The kernel is packaged and compiled from its package. The first example of its README, in a
/// crate with the README's lines of the manifest, compiles and runs with success.
#[test]
fn the_readmes_example_runs_in_an_empty_crate() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let target = folder.path().join("target").display().to_string();

    // Cargo unpacks and compiles the package that it has made.
    cargo(
        &[
            "package",
            "--package",
            "double-pendulum-kernel",
            "--allow-dirty",
            "--target-dir",
            &target,
        ],
        workspace(),
    );

    let package = format!(
        "{target}/package/double-pendulum-kernel-{}",
        env!("CARGO_PKG_VERSION")
    );

    // The README's lines for the manifest, with the path of the package.
    let readme =
        fs::read_to_string(format!("{package}/README.md")).expect("the package has its README");
    let (before, path) = block(&readme, "toml")
        .split_once("path = \"")
        .expect("a path while on no registry");
    let (_, after) = path.split_once('"').expect("it ends");
    let empty = folder.path().join("empty");
    fs::create_dir_all(empty.join("src")).expect("a temporary folder can be written to");
    let manifest = format!(
        "[workspace]\n[package]\nname = \"empty\"\nedition = \"2024\"\n\
        {before}path = \"{package}\"{after}"
    );
    fs::write(empty.join("Cargo.toml"), manifest).expect("a file");
    fs::write(empty.join("src/main.rs"), block(&readme, "rust")).expect("a file");
    cargo(&["run", "--target-dir", &target], &empty);
}
