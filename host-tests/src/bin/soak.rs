//! `cargo soak`: an hour of scenes on every board, and a day of physics on a Cortex-M4F.

use std::process::ExitCode;
use std::time::Duration;

use anyhow::Context;
use clap::Parser;
use host_tests::commands::soak::{self, Outcome};
use host_tests::console::cli::{self, Refused, say};
use host_tests::console::progress::Bar;
use host_tests::emulator::boards::{BOARDS, Board};
use host_tests::emulator::qemu::{Clock, Settings};
use host_tests::emulator::toolchain::{self, Toolchain};

/// The board that computes physics alone: it has no panel.
const PHYSICS_BOARD: &str = "mps2-an386";
/// Guards against a hang: the slowest board on a slow host takes a tenth of it.
const LIMIT: Duration = Duration::from_secs(6 * 3600);

/// Runs every board for long: all scenes twice, the second time as the first, then physics alone.
#[derive(Debug, Parser)]
#[command(name = "cargo soak", after_help = "Example: cargo soak --board mps2-an386 --scenes 300 --physics 60")]
struct Arguments {
    /// Seconds of the board's time with scenes, on each board; 0 for none
    #[arg(long, default_value_t = 3600)]
    scenes: u32,
    /// Minutes of a motion's time, in steps of 1/256 s; 0 for none
    #[arg(long, default_value_t = 24 * 60)]
    physics: u32,
    /// Only this board
    #[arg(long, value_parser = cli::choice(&BOARDS, |board| board.name))]
    board: Option<&'static Board>,
}

fn main() -> ExitCode {
    cli::main(|arguments| run(arguments).map(cli::verdict))
}

/// Whether all was well.
fn run(arguments: &Arguments) -> anyhow::Result<bool> {
    let (toolchain, _) = toolchain::set_up().map_err(Refused::because)?;
    let mut well = true;
    let mut report = |board: &Board, what: String, outcome: Outcome| {
        well &= outcome.faults.is_empty();
        say(format_args!("{:15} {what}: {outcome}", board.name))
    };
    let boards = match arguments.board {
        Some(board) => std::slice::from_ref(board),
        None => &BOARDS,
    };
    for board in boards {
        if arguments.scenes > 0 {
            let bar = Bar::start(board.name, arguments.scenes.into());
            let outcome =
                on(&toolchain, board, |settings| soak::scenes(settings, arguments.scenes, || bar.advance(1)))?;
            drop(bar);
            report(board, format!("{} s of scenes", arguments.scenes), outcome)?;
        }
        if arguments.physics > 0 && board.name == PHYSICS_BOARD {
            let bar = Bar::start(board.name, arguments.physics.into());
            let outcome =
                on(&toolchain, board, |settings| soak::physics(settings, arguments.physics, || bar.advance(1)))?;
            drop(bar);
            report(board, format!("{} min of physics", arguments.physics), outcome)?;
        }
    }
    Ok(well)
}

fn on<T, E>(
    toolchain: &Toolchain,
    board: &'static Board,
    run: impl FnOnce(&Settings) -> Result<T, E>,
) -> anyhow::Result<T>
where
    E: std::error::Error + Send + Sync + 'static,
{
    let elf = toolchain.build_for(board)?;
    let settings = Settings {
        qemu: toolchain.qemu(),
        board,
        elf: &elf,
        clock: Clock::Counted,
        window: None,
        debugger: true,
        limit: LIMIT,
    };
    run(&settings).context(board.name)
}
