//! `cargo fw`: builds and runs any firmware binary; also cargo's own runner for the ARM targets.

use std::fs;
use std::io::{self, stdout};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use crate::console::cli::{Refused, complain};
use crate::emulator::boards::BOARDS;
use crate::emulator::firmware_run::{self, board_for};
use crate::emulator::process;
use crate::emulator::qemu::{Clock, Settings};
use crate::emulator::toolchain::{self, Toolchain};
use anyhow::bail;
use clap::Parser;

/// How long a firmware may run if `--seconds` does not say.
const LIMIT: Duration = Duration::from_secs(3600);

/// Builds a firmware binary, runs it in QEMU and prints its log; exits as the firmware does.
#[derive(Debug, Parser)]
#[command(name = "cargo fw", after_help = runnable())]
pub struct FwOptions {
    /// A binary of the firmware, or the path of an ELF file that is built already
    #[arg(value_name = "BIN", required_unless_present = "check")]
    binary: Option<PathBuf>,
    /// The board to run it on; else the first that it is made for
    #[arg(long, value_name = "NAME")]
    board: Option<String>,
    /// End it after this long, successfully; else it is given an hour, and to need more is an error
    #[arg(long, value_name = "N")]
    seconds: Option<u32>,
    /// Only check that all binaries compile for all targets without a warning, clippy's included if it is installed
    #[arg(long, conflicts_with = "binary")]
    check: bool,
}

pub fn run(options: &FwOptions) -> anyhow::Result<ExitCode> {
    let Some(binary) = &options.binary else {
        set_up()?.check()?;
        return Ok(ExitCode::SUCCESS);
    };
    let unknown = |kind: &str, name: &str, names: &[String]| {
        Refused::because(format_args!("no {kind} {name}; there are {}", names.join(", ")))
    };
    let asked = options.board.as_deref();
    let board = board_for(asked, binary)
        .ok_or_else(|| unknown("board", asked.unwrap_or_default(), &BOARDS.map(|board| board.name.to_owned())))?;
    let name = binary.to_string_lossy();
    let is_path = name.contains('/');
    if !is_path && !binaries().contains(&name.to_string()) {
        bail!(unknown("binary", &name, &binaries()));
    }
    let toolchain = set_up()?;
    let elf = if is_path { binary.clone() } else { toolchain.build(&name, board.target)? };
    let limit = options.seconds.map_or(LIMIT, |seconds| Duration::from_secs(seconds.into()));
    let settings = Settings { qemu: toolchain.qemu(), board, elf: &elf, clock: Clock::Real, debugger: true, limit };
    let is_late = |error: &io::Error| error.kind() == io::ErrorKind::TimedOut;
    match (firmware_run::run(&settings, &mut stdout().lock()), options.seconds) {
        (Err(error), Some(seconds)) if error.downcast_ref().is_some_and(is_late) => {
            complain(format_args!("ended after {seconds} s, as told"));
            Ok(ExitCode::SUCCESS)
        }
        (ended, _) => Ok(process::exit_code(ended?)),
    }
}

fn runnable() -> String {
    let boards = BOARDS.map(|board| format!("  {:16}{}, {} MHz", board.name, board.cpu, board.hertz / 1_000_000));
    format!(
        "Example: cargo fw mps2-an386 --seconds 10\n\nBinaries:\n  {}\n\nBoards:\n{}",
        binaries().join("\n  "),
        boards.join("\n")
    )
}

fn set_up() -> Result<Toolchain, Refused> {
    toolchain::set_up().map(|(toolchain, _)| toolchain)
}

fn binaries() -> Vec<String> {
    let Ok(files) = fs::read_dir(toolchain::workspace().join("firmware/src/bin")) else { return Vec::new() };
    let stem = |file: fs::DirEntry| Some(file.path().file_stem()?.to_string_lossy().into_owned());
    let mut names: Vec<_> = files.flatten().filter_map(stem).collect();
    names.sort();
    names
}
