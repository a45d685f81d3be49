//! `cargo setup`, `cargo fw` and `cargo verify`: install the tools, run a firmware on an emulated
//! board, run every test.

use std::io::{self, Read, Seek, Write, stdout};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::thread::{self, available_parallelism};
use std::time::Duration;
use std::{env, fs};

use anyhow::bail;
use clap::Parser;
use cycles::Image;

use boards::console::cli::{Refused, choice_with_aliases, complain, say};
use boards::process;
use boards::qemu::{Clock, Machine, MachineSettings};
use boards::toolchain;
use boards::{BOARDS, Board, PICO};

/// Finds or fetches everything that builds and runs the firmware: Rust's core library, QEMU, and
/// Node.js with rp2040js for the Pico.
#[derive(Debug, Parser)]
#[command(
    name = "cargo setup",
    after_help = "Everything goes into target, host-tests/boards/rp2040 and rustup's own folder. Nothing is
installed on the system."
)]
pub struct SetupOptions {}

pub fn setup(_: &SetupOptions) -> anyhow::Result<()> {
    let is_ready = toolchain::ready().is_ok() && toolchain::ready_for_pico().is_ok();
    say(toolchain::set_up()?)?;
    say(format_args!(
        "Raspberry Pi Pico: rp2040js under {}",
        toolchain::set_up_pico()?.display()
    ))?;
    if is_ready {
        say("everything was ready")?;
    }
    Ok(())
}

const LIMIT: Duration = Duration::from_secs(3600);

/// Builds a firmware binary, runs it in QEMU and prints its log; the exit code is the firmware's.
#[derive(Debug, Parser)]
#[command(name = "cargo fw", after_help = runnable())]
pub struct FwOptions {
    /// A binary of the firmware, or the path of an existing ELF file
    #[arg(value_name = "BIN", required_unless_present = "check")]
    binary: Option<PathBuf>,
    /// The board to run it on [default: the first below whose application it is, else the first]
    #[arg(
        long,
        alias = "on",
        alias = "target",
        value_name = "NAME",
        value_parser = choice_with_aliases(&BOARDS, Board::names),
        hide_possible_values = true,
    )]
    board: Option<&'static Board>,
    /// Stop it after this many seconds, with exit code 0 [default: fails after one hour]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    seconds: Option<u32>,
    /// Only check that all binaries compile for all targets without a warning, clippy's included
    #[arg(long, conflicts_with = "binary")]
    check: bool,
}

/// Runs a firmware and prints its log. Cargo also uses this command as the runner for the ARM
/// targets.
pub fn fw(options: &FwOptions) -> anyhow::Result<ExitCode> {
    let Some(binary) = &options.binary else {
        toolchain::set_up()?.check()?;
        return Ok(ExitCode::SUCCESS);
    };
    let name = binary.to_string_lossy();
    // A name with a slash is a file, any other name is a binary of the firmware.
    let is_path = name.contains('/');

    if !is_path && !binaries().iter().any(|binary| *binary == name) {
        bail!(Refused::because(format_args!(
            "{name}: no binary of the firmware; choose one of {}, or write a path",
            binaries().join(", ")
        )));
    }

    if name == PICO.binary {
        bail!(Refused::because(
            "pico: QEMU has no Raspberry Pi Pico; run cargo demo --board pico"
        ));
    }

    if is_path {
        Image::read(binary).map_err(|error| Refused::because(format_args!("{error:#}")))?;
    }

    let board = options.board.unwrap_or_else(|| board_for(binary));
    let toolchain = toolchain::set_up()?;
    let elf = if is_path {
        binary.clone()
    } else {
        toolchain.build(&name, board.target)?
    };

    let limit = options
        .seconds
        .map_or(LIMIT, |seconds| Duration::from_secs(seconds.into()));
    let settings = MachineSettings {
        qemu: &toolchain.qemu,
        board,
        elf: &elf,
        clock: Clock::Real,
        debugger: true,
        limit,
    };
    let mut machine = Machine::start(&settings)?;
    let mut output = stdout().lock();

    let ended = machine.wait(|line| drop(writeln!(output, "{line}").and_then(|()| output.flush())));

    let is_late = |error: &anyhow::Error| {
        error.downcast_ref().map(io::Error::kind) == Some(io::ErrorKind::TimedOut)
    };

    match (ended, options.seconds) {
        (Err(error), Some(seconds)) if is_late(&error) => {
            complain(format_args!("stopped after {seconds} s, as requested"));
            Ok(ExitCode::SUCCESS)
        }
        (ended, _) => Ok(process::exit_code(ended?)),
    }
}

/// Returns a board that runs the binary; a target in the path selects it.
fn board_for(binary: &Path) -> &'static Board {
    let is_target = |board: &&Board| {
        binary
            .components()
            .any(|folder| folder.as_os_str() == board.target)
    };
    let of_target: Vec<_> = BOARDS.iter().filter(is_target).collect();
    let boards = if of_target.is_empty() {
        BOARDS.iter().collect()
    } else {
        of_target
    };
    let runs_it = |board: &&&Board| binary.file_name().is_some_and(|file| file == board.binary);
    boards.iter().find(runs_it).unwrap_or(&boards[0])
}

fn runnable() -> String {
    let boards = BOARDS.map(|board| {
        format!(
            "  {:16}{}, {} MHz",
            board.name,
            board.cpu,
            board.hertz / 1_000_000
        )
    });
    let binaries = binaries().join("\n  ");
    let boards = boards.join("\n");
    format!(
        "Example: cargo fw lm3s6965evb --seconds 10\n\nBinaries:\n  {binaries}\n\nBoards:\n{boards}"
    )
}

fn binaries() -> Vec<String> {
    let Ok(files) = fs::read_dir(toolchain::workspace().join("firmware/src/bin")) else {
        return Vec::new();
    };
    let stem = |file: fs::DirEntry| Some(file.path().file_stem()?.to_string_lossy().into_owned());
    let mut names: Vec<_> = files.flatten().filter_map(stem).collect();
    names.sort();
    names
}

/// Sets everything up and runs all tests, including those in QEMU. Takes about eight minutes.
#[derive(Debug, Parser)]
#[command(name = "cargo verify", after_help = "Example: cargo verify --long")]
pub struct TestOptions {
    /// Also run the tests that take hours
    #[arg(long)]
    long: bool,
}

const LIMITS: [Duration; 2] = [Duration::from_secs(3600), Duration::from_secs(12 * 3600)];
/// The variables with the numbers of concurrent tests, and of concurrent pieces of work within
/// tests. More than processors, because many tests wait for an emulator or a clock.
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
pub fn verify(options: &TestOptions) -> anyhow::Result<ExitCode> {
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
        "note: all tests take about eight minutes"
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
            shown(run(&ON_HOST, 2 * processors))
        });

        let toolchain = toolchain::set_up()?;
        toolchain::set_up_pico()?;
        toolchain.build_ahead()?;
        let others = scope.spawn({
            let toolchain = toolchain.clone();
            move || {
                toolchain.build_minimal_ahead()?;
                toolchain.build_cores_ahead()
            }
        });
        toolchain.build_applications_ahead()?;
        // Without the tools the test says that it is skipped.
        if let Ok(web) = toolchain::set_up_web() {
            web.build_web()?;
        }
        others.join().expect("it does not panic")?;
        let status = on_host.join().expect("it does not panic")?;
        anyhow::Ok(status)
    })?;
    if !on_host.success() {
        return Ok(process::exit_code(on_host));
    }

    // Many of the other tests wait for a board, and the rest compute meanwhile. Two parts write to
    // files, so that nothing is lost if one of them is stopped.
    let parts = [OF_COMMANDS, IN_DOCUMENTATION];
    let mut outputs = [tempfile::tempfile()?, tempfile::tempfile()?];
    let results = thread::scope(|scope| {
        let others = [0, 1].map(|i| {
            let part = parts[i];
            let output = &outputs[i];
            scope.spawn(move || {
                let mut command = run(&[part], processors);
                command.stdout(output.try_clone()?);
                command.stderr(output.try_clone()?);
                shown(command)
            })
        });
        let on_boards = shown(run(&[ON_BOARDS], processors));
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
        let entries = fs::read_dir(toolchain::workspace().join(folder)).expect("the sources");
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

/// The target in a path selects the board.
#[test]
fn the_board_follows_from_the_binary() {
    for (binary, name) in [
        ("lm3s6965evb", "lm3s6965evb"),
        ("inject-panic", "lm3s6965evb"),
        (
            "target/thumbv7em-none-eabihf/release/lm3s6965evb",
            "lm3s6965evb-m4",
        ),
        (
            "target/thumbv7em-none-eabihf/release/inject-panic",
            "lm3s6965evb-m4",
        ),
    ] {
        assert_eq!(board_for(Path::new(binary)).name, name, "{binary}");
    }
}
