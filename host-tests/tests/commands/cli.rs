//! The output of the commands. The files `golden/commands/*.txt` contain command lines after `$`,
//! with their lines on stdout after `> `, those on stderr after `! `, and the exit code. `BLESS=1`
//! writes them again.

use std::ffi::OsStr;
use std::os::unix::ffi::OsStrExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::{fs, io};

use crate::support::snapshot::BLESS;
use boards::host::Show;
use boards::process::{Output, run};
use boards::toolchain::workspace;
use firmware::app::PlannerEvent;
use firmware::config::{CORTEX_M3, STM32F405};
use firmware::scenes::SceneName;
use rayon::prelude::*;

use crate::support::{LIMIT, toolchain};

pub fn program(name: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_host-tests"));
    command.arg(name);
    command
}

pub fn output(command: &mut Command) -> Output {
    run(command, LIMIT).unwrap_or_else(|error| panic!("{error}"))
}

fn played(line: &str, folder: &Path) -> String {
    let mut words = line.split_whitespace();
    let output = output(
        program(words.next().unwrap_or_default())
            .args(words)
            .current_dir(folder),
    );
    let mut text = format!("$ {line}\n");
    for (mark, said) in [('>', output.stdout), ('!', output.stderr)] {
        // A slow machine also prints progress, which is left out.
        text.extend(
            said.lines()
                .filter(|line| !line.contains(" ..."))
                .map(|line| format!("{mark} {line}\n")),
        );
    }
    let code = output.status.code();
    text + &code.map_or(String::from("killed\n"), |code| format!("exit {code}\n"))
}

#[test]
fn output_of_every_command_equals_its_snapshot() {
    // Without the tools a command would fetch them, and print a line that no snapshot has.
    toolchain();
    let empty = tempfile::tempdir().expect("a folder");
    let folder = workspace().join("host-tests/golden/commands");
    let files = fs::read_dir(folder)
        .expect("the snapshots")
        .map(|file| file.expect("a file").path());
    let mut differences = Vec::new();

    for file in files {
        let old =
            fs::read_to_string(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let lines: Vec<_> = old
            .lines()
            .filter_map(|line| line.strip_prefix("$ "))
            .collect();
        let blocks: Vec<_> = lines
            .par_iter()
            .map(|line| played(line, empty.path()))
            .collect();

        for block in blocks.iter().filter(|_| file.ends_with("refused.txt")) {
            let lines: Vec<_> = block.lines().collect();
            assert!(
                matches!(lines[..], [_, why, "exit 2"] if why.starts_with("! error: ")),
                "{block}"
            );
        }

        if std::env::var_os(BLESS).is_some() {
            fs::write(&file, blocks.join("\n"))
                .unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        } else {
            let is_new = |block: &&String| !old.contains(block.as_str());
            differences.extend(
                blocks
                    .iter()
                    .filter(is_new)
                    .map(|block| format!("{}\n{block}", file.display())),
            );
        }
    }

    assert_eq!(
        fs::read_dir(&empty).expect("a folder").count(),
        0,
        "something is written"
    );
    assert!(
        differences.is_empty(),
        "accept by {BLESS}=1:\n{}",
        differences.join("\n")
    );
}

/// Commands that print by clap, in rows and in one piece.
const COMMANDS: [&str; 3] = [
    "verify --help",
    "simulate --angles 1,1",
    "plan --angles 1,1",
];

fn closed() -> io::Result<Stdio> {
    let (reader, writer) = io::pipe()?;
    drop(reader);
    Ok(writer.into())
}

#[test]
fn a_closed_output_ends_every_command_quietly() -> io::Result<()> {
    for line in COMMANDS {
        let (name, arguments) = line.split_once(' ').unwrap_or((line, ""));
        let output = program(name)
            .args(arguments.split_whitespace())
            .stdout(closed()?)
            .output()?;
        let report = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{line}: {report}");

        assert!(
            !report.contains("error") && !report.contains("panicked"),
            "{line}: {report}"
        );
    }

    let status = program("simulate")
        .args(["--seconds", "-1"])
        .stdout(closed()?)
        .stderr(closed()?)
        .status()?;
    assert_eq!(status.code(), Some(2));
    Ok(())
}

#[test]
fn an_argument_that_is_no_text_is_refused() {
    let word = OsStr::from_bytes(b"\xff");
    let mut commands = [
        Command::new(env!("CARGO_BIN_EXE_host-tests")),
        program("plan"),
    ];
    for command in &mut commands {
        let output = output(command.arg(word));
        assert_eq!(output.status.code(), Some(2), "{output:?}");
        let lines: Vec<_> = output.stderr.lines().collect();
        assert!(
            matches!(lines[..], [line] if line.starts_with("error: ")),
            "{output:?}"
        );
    }
}

#[test]
fn a_scene_is_planned_as_the_boards_start_it() {
    let name = SceneName::Page;
    for (board, processor) in [("lm3s6965evb", CORTEX_M3), ("stm32f405", STM32F405)] {
        let mut show =
            Show::on(processor, name, &name.first_settings()).expect("a scene of the catalogue");
        let horizon = loop {
            show.tick();
            if let [.., (_, PlannerEvent::Found(Ok(plan)))] = show.news[..] {
                break plan.horizon;
            }
        };
        let expected = format!("until {horizon:.2} s of 30 s");
        for options in ["--scene page", "--angles 120,120 --degrees --height 57"] {
            let options = options.split(' ').chain(["--board", board]);
            let text = output(program("plan").args(options)).stdout;
            assert!(text.contains(&expected), "{horizon} {text}");
        }
    }
}

/// Waits until a process handles SIGTERM itself. By then `prove` has its plan.
#[cfg(target_os = "linux")]
fn wait_for_handler(process: u32) {
    const SIGTERM_BIT: u64 = 1 << (15 - 1);
    loop {
        let status = fs::read_to_string(format!("/proc/{process}/status")).expect("it runs");
        let caught = status
            .lines()
            .find_map(|line| line.strip_prefix("SigCgt:"))
            .and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok())
            .expect("a mask of signals");
        if caught & SIGTERM_BIT != 0 {
            return;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn an_interrupted_proof_prints_what_it_has_proved() {
    use boards::process::spawn;
    use nix::sys::signal::{Signal, kill};
    use nix::unistd::Pid;
    use std::io::Read;

    let words = "--angles 0.1,0.1 --seconds 1e3 --method rk4-fixed32 --steps 16";
    for signal in [Signal::SIGINT, Signal::SIGTERM] {
        let mut command = program("prove");
        command
            .args(words.split_whitespace())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut running = spawn(&mut command, LIMIT).expect("it starts");
        let process = running.child.id();
        wait_for_handler(process);
        kill(Pid::from_raw(process as i32), signal).expect("it runs");

        let mut text = String::new();
        let mut output = running.child.stdout.take().expect("piped");
        output.read_to_string(&mut text).expect("text");
        let status = running.wait().expect("it ends by itself");
        assert_eq!(status.code(), Some(128 + signal as i32), "{text}");
        assert!(
            text.contains("interrupted after ") && text.contains("proved     within"),
            "{text}"
        );
    }
}
