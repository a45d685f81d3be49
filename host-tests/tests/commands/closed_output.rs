//! Every command whose reader has seen enough (`| head`) ends quietly and with success.

use std::io;
use std::process::{Command, Stdio};

use host_tests::emulator::toolchain;

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
    let figures = ["--folder", folder.path().to_str().expect("text")];
    let commands: [(&str, &[&str]); 13] = [
        (env!("CARGO_BIN_EXE_count"), &["closed-form-f32", "--on", "lm3s6965evb", "--steps", "4"]),
        (env!("CARGO_BIN_EXE_count"), &["closed-form-f32", "--on", "lm3s6965evb", "--steps", "4", "--listing"]),
        (env!("CARGO_BIN_EXE_count"), &["--help"]),
        (env!("CARGO_BIN_EXE_demo"), &["--headless", "--seconds", "0.1"]),
        (env!("CARGO_BIN_EXE_figures"), &figures),
        // Prints nothing of its own but this.
        (env!("CARGO_BIN_EXE_flash-f4"), &["--help"]),
        (env!("CARGO_BIN_EXE_fw"), &["mps2-an386", "--seconds", "2"]),
        (env!("CARGO_BIN_EXE_plan"), &["--angles", "1,1"]),
        (env!("CARGO_BIN_EXE_plan"), &["--study", "1"]),
        // Takes minutes to print more.
        (env!("CARGO_BIN_EXE_report"), &["--help"]),
        (env!("CARGO_BIN_EXE_setup"), &[]),
        (env!("CARGO_BIN_EXE_simulate"), &["--angles", "1,1"]),
        // What follows is cargo's.
        (env!("CARGO_BIN_EXE_verify"), &["--help"]),
    ];
    for (command, arguments) in commands {
        let output = Command::new(command).args(arguments).stdout(closed()?).stderr(Stdio::piped()).output()?;
        let report = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{command} {arguments:?}: {report}");
        // What is going on may be said there, but nothing went wrong.
        assert!(!report.contains("error") && !report.contains("panicked"), "{command} {arguments:?}: {report}");
    }
    Ok(())
}

/// An error that is read by no one is still told by the exit code.
#[test]
fn with_both_outputs_closed_a_refusal_is_still_exit_code_2() -> io::Result<()> {
    for (command, option) in [
        (env!("CARGO_BIN_EXE_count"), "--steps"),
        (env!("CARGO_BIN_EXE_demo"), "--seconds"),
        (env!("CARGO_BIN_EXE_plan"), "--duration"),
        (env!("CARGO_BIN_EXE_simulate"), "--until"),
    ] {
        let status = Command::new(command).args([option, "-1"]).stdout(closed()?).stderr(closed()?).status()?;
        assert_eq!(status.code(), Some(2), "{command} {option} -1");
    }
    Ok(())
}
