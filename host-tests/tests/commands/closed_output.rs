//! Every command whose reader has seen enough (`| head`) ends quietly and with success.

use std::io;
use std::process::Stdio;

use host_tests::emulator::toolchain;

use super::cli::program;

/// What ends after little work; of others, what is their own to print.
const COMMANDS: [&str; 12] = [
    "count closed-form-f32 --on lm3s6965evb --steps 4",
    "count closed-form-f32 --on lm3s6965evb --steps 4 --listing",
    "count --help",
    "demo --headless --seconds 0.1",
    "figures --folder .",
    "flash-f4 --help",
    "fw mps2-an386 --seconds 2",
    "plan --angles 1,1",
    "write-report --help",
    "setup",
    "simulate --angles 1,1",
    "verify --help",
];

/// A pipe that is closed at its other end.
fn closed() -> io::Result<Stdio> {
    let (reader, writer) = io::pipe()?;
    drop(reader);
    Ok(writer.into())
}

#[test]
fn a_closed_output_ends_every_command_quietly() -> io::Result<()> {
    toolchain::ready().unwrap_or_else(|missing| panic!("{missing}"));
    let folder = tempfile::tempdir()?;
    for line in COMMANDS {
        let (name, arguments) = line.split_once(' ').unwrap_or((line, ""));
        let mut command = program(name);
        command.args(arguments.split_whitespace()).stdout(closed()?).stderr(Stdio::piped());
        if name == "figures" {
            command.current_dir(folder.path());
        }
        let output = command.output()?;
        let report = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{line}: {report}");
        // What is going on may be said there, but nothing went wrong.
        assert!(!report.contains("error") && !report.contains("panicked"), "{line}: {report}");
    }
    Ok(())
}

/// An error that is read by no one is still told by the exit code.
#[test]
fn with_both_outputs_closed_a_refusal_is_still_exit_code_2() -> io::Result<()> {
    let status = program("simulate").args(["--until", "-1"]).stdout(closed()?).stderr(closed()?).status()?;
    assert_eq!(status.code(), Some(2));
    Ok(())
}
