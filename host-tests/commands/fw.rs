//! `cargo fw`: runs a firmware on an emulated board.

use std::fs;
use std::io::{self, Write, stdout};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use anyhow::bail;
use clap::Parser;
use cycles::Image;

use boards::console::cli::{Refused, choice_with_aliases, complain};
use boards::process;
use boards::qemu::{Clock, Machine, MachineSettings};
use boards::toolchain;
use boards::{BOARDS, Board, PICO};

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
pub fn run(options: &FwOptions) -> anyhow::Result<ExitCode> {
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

/// The target in a path selects the board.
#[test]
fn the_board_follows_from_the_binary() {
    for (binary, name) in [
        ("lm3s6965evb", "lm3s6965evb"),
        ("measure", "lm3s6965evb"),
        (
            "target/thumbv7em-none-eabihf/release/lm3s6965evb",
            "lm3s6965evb-m4",
        ),
        (
            "target/thumbv7em-none-eabihf/release/measure",
            "lm3s6965evb-m4",
        ),
    ] {
        assert_eq!(board_for(Path::new(binary)).name, name, "{binary}");
    }
}
