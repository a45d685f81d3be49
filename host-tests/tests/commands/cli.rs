//! The commands' own words: `snapshots/*.txt` hold command lines, and what each says and ends with. `BLESS=1` writes them anew.
//!
//! After `$` a command and its arguments; then a line for each on stdout, after `> `, and on stderr, after `! `; and the exit code.

use std::fs;
use std::path::Path;
use std::process::Command;

use host_tests::emulator::process::{Output, run};
use host_tests::emulator::toolchain::workspace;
use host_tests::oracle::snapshot::BLESS;
use rayon::prelude::*;

use crate::support::LIMIT;

/// A command of this project.
pub fn program(name: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-tests"));
    command.arg(name);
    command
}

/// What it says, and how it ends.
pub fn output(command: &mut Command) -> Output {
    run(command, LIMIT).unwrap_or_else(|error| panic!("{error}"))
}

/// What a command line of this project's does in `folder`, as a snapshot has it.
fn played(line: &str, folder: &Path) -> String {
    let mut words = line.split_whitespace();
    let output = output(program(words.next().unwrap_or_default()).args(words).current_dir(folder));
    let mut text = format!("$ {line}\n");
    for (mark, said) in [('>', output.stdout), ('!', output.stderr)] {
        // a slow machine says that work goes on
        text.extend(said.lines().filter(|line| !line.contains(" ... ")).map(|line| format!("{mark} {line}\n")));
    }
    let code = output.status.code();
    text + &code.map_or(String::from("killed\n"), |code| format!("exit {code}\n"))
}

#[test]
fn commands_say_what_they_said() {
    let empty = tempfile::tempdir().expect("a folder");
    let folder = workspace().join("host-tests/tests/commands/snapshots");
    let files = fs::read_dir(folder).expect("the snapshots").map(|file| file.expect("a file").path());
    let mut differences = Vec::new();
    for file in files {
        let old = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let lines: Vec<_> = old.lines().filter_map(|line| line.strip_prefix("$ ")).collect();
        let blocks: Vec<_> = lines.par_iter().map(|line| played(line, empty.path())).collect();
        // Every refusal: one line, nothing on stdout, exit code 2, nothing written.
        for block in blocks.iter().filter(|_| file.ends_with("refused.txt")) {
            let lines: Vec<_> = block.lines().collect();
            assert!(matches!(lines[..], [_, why, "exit 2"] if why.starts_with("! error: ")), "{block}");
        }
        if std::env::var_os(BLESS).is_some() {
            fs::write(&file, blocks.join("\n")).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        } else {
            let is_new = |block: &&String| !old.contains(block.as_str());
            differences.extend(blocks.iter().filter(is_new).map(|block| format!("{}\n{block}", file.display())));
        }
    }
    assert_eq!(fs::read_dir(&empty).expect("a folder").count(), 0, "something is written");
    assert!(differences.is_empty(), "accept by {BLESS}=1:\n{}", differences.join("\n"));
}
