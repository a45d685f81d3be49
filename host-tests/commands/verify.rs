//! `cargo verify`: runs all tests.

use std::env;
use std::io::{Read, Seek};
use std::process::{Command, ExitCode, Stdio};
use std::thread::{self, available_parallelism};
use std::time::Duration;

use clap::Parser;

use boards::console::cli::{complain, say};
use boards::process;
use boards::toolchain;

/// Sets everything up and runs all tests, including those in QEMU. Takes about seven minutes.
#[derive(Debug, Parser)]
#[command(name = "cargo verify", after_help = "Example: cargo verify --long")]
pub struct VerifyOptions {
    /// Also run the tests that take hours
    #[arg(long)]
    long: bool,
}

const LIMITS: [Duration; 2] = [Duration::from_secs(3600), Duration::from_secs(12 * 3600)];
/// The variables with the numbers of concurrent tests, and of concurrent pieces of work within
/// tests.
const THREADS: [&str; 2] = ["RUST_TEST_THREADS", "RAYON_NUM_THREADS"];

const ON_HOST: [&str; 5] = [
    "--lib",
    "--test=firmware",
    "--test=kernel",
    "--test=prove",
    "--test=traits",
];
const ON_BOARDS: &str = "--test=boards";
const OF_COMMANDS: &str = "--test=commands";
const IN_DOCUMENTATION: &str = "--doc";

/// Sets up, and runs `cargo test` in four parts: on the host during the installation and the
/// builds, and then on the boards, of the commands and of the documentation, all at once. Returns
/// the exit code of the first part that fails. Without the tools of the page for a browser, its
/// tests are skipped.
pub fn run(options: &VerifyOptions) -> anyhow::Result<ExitCode> {
    let limit = LIMITS[usize::from(options.long)];
    let processors = available_parallelism()?.get();
    let test = |arguments: &[&str], threads: usize| {
        let mut command = Command::new("cargo");
        command
            .arg("test")
            .args(arguments)
            .current_dir(toolchain::workspace())
            .stdin(Stdio::null());
        for name in THREADS {
            if env::var_os(name).is_none() {
                command.env(name, threads.to_string());
            }
        }
        command
    };
    complain(if options.long {
        "note: running all tests, including those that take hours"
    } else {
        "note: all tests take about seven minutes"
    });

    let ignored: &[&str] = if options.long {
        &["--", "--include-ignored"]
    } else {
        &[]
    };
    let run = |tests: &[&str], threads| test(&[tests, ignored].concat(), threads);
    let shown = |mut command: Command| process::spawn(&mut command, limit)?.wait();

    // The tests are compiled, and those that need no firmware are run, while the tools are fetched
    // and the firmware is compiled, because none of these keeps all processors busy alone.
    let on_host = thread::scope(|scope| {
        let on_host = scope.spawn(|| {
            let compiled = shown(test(&["--no-run", "--quiet"], processors))?;
            if !compiled.success() {
                return Ok(compiled);
            }
            shown(run(&ON_HOST, processors))
        });

        let toolchain = toolchain::set_up()?;
        toolchain::set_up_pico()?;
        toolchain.build_ahead()?;
        toolchain.build_applications_ahead()?;
        // Without the tools the test says that it is skipped.
        if let Ok(web) = toolchain::set_up_web() {
            web.build_web()?;
        }
        let minimal = scope.spawn({
            let toolchain = toolchain.clone();
            move || toolchain.build_minimal_ahead()
        });
        toolchain.build_cores_ahead()?;
        minimal.join().expect("it does not panic")?;
        let status = on_host.join().expect("it does not panic")?;
        anyhow::Ok(status)
    })?;
    if !on_host.success() {
        return Ok(process::exit_code(on_host));
    }

    // Many of the other tests wait for a board or a clock, and the rest compute meanwhile. None of
    // them calls cargo again for an image that has just been built. Two parts write to files, so
    // that nothing is lost if one of them is stopped.
    let built = toolchain::built_images()?;
    let run = |tests: &[&str], threads| {
        let mut command = run(tests, threads);
        command.env(toolchain::BUILT_IMAGES, &built);
        command
    };
    let parts = [OF_COMMANDS, IN_DOCUMENTATION];
    let mut outputs = [tempfile::tempfile()?, tempfile::tempfile()?];
    let results = thread::scope(|scope| {
        let others = [0, 1].map(|i| {
            let part = parts[i];
            let output = &outputs[i];
            scope.spawn(move || {
                let mut command = run(&[part], 2 * processors);
                command.stdout(output.try_clone()?);
                command.stderr(output.try_clone()?);
                shown(command)
            })
        });
        let on_boards = shown(run(&[ON_BOARDS], processors + 1));
        let [of_commands, in_documentation] =
            others.map(|other| other.join().expect("it does not panic"));
        [on_boards, of_commands, in_documentation]
    });
    let printed = outputs.iter_mut().try_for_each(|output| {
        let mut text = Vec::new();
        output.rewind()?;
        output.read_to_end(&mut text)?;
        say(String::from_utf8_lossy(&text).trim_end())
    });

    for (part, result) in [ON_BOARDS, OF_COMMANDS, IN_DOCUMENTATION]
        .iter()
        .zip(results)
    {
        let status = result?;
        if !status.success() {
            complain(format_args!("error: cargo test {part} failed"));
            return Ok(process::exit_code(status));
        }
    }
    printed?;
    say("all tests passed")?;
    Ok(ExitCode::SUCCESS)
}

/// `cargo verify` leaves no test program out.
#[test]
fn every_test_program_is_run() {
    let listed = |name: &str| {
        let test = format!("--test={name}");
        ON_HOST.contains(&&*test) || [ON_BOARDS, OF_COMMANDS].contains(&&*test)
    };
    let mut found = 0;
    for folder in ["kernel/tests", "host-tests/tests"] {
        let entries = std::fs::read_dir(toolchain::workspace().join(folder)).expect("the sources");
        for entry in entries.flatten() {
            let path = entry.path();
            if path.extension().is_some_and(|end| end == "rs") || path.join("main.rs").exists() {
                let name = path.file_stem().expect("it has a name").to_string_lossy();
                assert!(listed(&name), "{name}");
                found += 1;
            }
        }
    }
    assert!(found >= 5, "{found}");
}
