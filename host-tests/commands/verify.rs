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

/// Sets everything up and runs all tests, including those in QEMU. Takes about six minutes.
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

/// Sets up, and runs `cargo test` in four parts. Returns the exit code of the first that fails.
///
/// One thread compiles all tests and runs those without firmware. Another fetches the tools and
/// builds the images, because neither keeps all processors busy alone. The tests of the commands and
/// the documentation start once the applications are built, and the tests on the boards last.
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
        "note: all tests take about six minutes"
    });

    let ignored: &[&str] = if options.long {
        &["--", "--include-ignored"]
    } else {
        &[]
    };
    let run = |tests: &[&str], threads| test(&[tests, ignored].concat(), threads);
    // Twice as many threads as processors, because many of these tests wait for a board or a clock.
    let run_built = |part| {
        let mut command = run(&[part], 2 * processors);
        command.env(toolchain::BUILT_IMAGES, toolchain::built_images()?);
        anyhow::Ok(command)
    };
    let shown = |mut command: Command| process::spawn(&mut command, limit)?.wait();

    // Two parts write to files, so that nothing is lost if one of them is stopped.
    let mut outputs = [tempfile::tempfile()?, tempfile::tempfile()?];
    let results = thread::scope(|scope| {
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

        let mut others = Vec::new();
        for (part, output) in [OF_COMMANDS, IN_DOCUMENTATION].into_iter().zip(&outputs) {
            let mut command = run_built(part)?;
            command.stdout(output.try_clone()?);
            command.stderr(output.try_clone()?);
            others.push((part, scope.spawn(move || shown(command))));
        }

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

        let mut results = vec![("on the host", on_host.join().expect("it does not panic")?)];
        if results[0].1.success() {
            results.push((ON_BOARDS, shown(run_built(ON_BOARDS)?)?));
        }
        for (part, other) in others {
            results.push((part, other.join().expect("it does not panic")?));
        }
        anyhow::Ok(results)
    });
    // Printed even if a build has failed.
    let printed = outputs.iter_mut().try_for_each(|output| {
        let mut text = Vec::new();
        output.rewind()?;
        output.read_to_end(&mut text)?;
        if text.is_empty() {
            return Ok(());
        }
        say(String::from_utf8_lossy(&text).trim_end())
    });

    for (part, status) in results? {
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
