//! `cargo verify-board`: what the tests prove in emulation, proven on a board in the hand, with a report to be sent in.

mod bits;
mod cycles;
mod options;
mod program;
mod questions;
mod report;
mod scenes;
mod talk;

pub use options::Options;

use firmware::protocol::{BoardName, Identify, Identity};

use crate::commands::demo;
use crate::console::cli::{complain, say};
use crate::console::progress::Progress;
use crate::emulator::boards::{BOARDS, every_board};
use report::{Chip, Report};
use talk::Talk;

/// Verifies the board and writes the report; whether all was well.
pub fn run(options: &Options) -> anyhow::Result<bool> {
    let mut talk = Talk::new(demo::port(&options.port, options.baud)?)?;
    let identity: Identity = talk.ask(&Identify { request: 0 })?;
    let name = BoardName::from_code(identity.board).map_or("unknown", BoardName::name);
    let progress = Progress::start(&format!("verifying {name} at {}", talk.port.name()));
    let bits = bits::check(&mut talk)?;
    let mut cycles = cycles::measure(&mut talk)?;
    let scenes = scenes::watch(&mut talk, identity.hertz)?;
    drop(progress);
    let asked = if options.no_questions { vec![] } else { questions::ask(&mut talk, name)? };
    let board = every_board().find(|board| board.name == name);
    let program = program::compare(board, &identity)?;
    // Instructions are counted in QEMU, on a board with the same processor.
    if let Some(board) = board.and_then(|board| BOARDS.iter().find(|counted| counted.target == board.target)) {
        cycles::estimate(&mut cycles, board)?;
    }
    let chip = Chip::new(name, &identity);
    let report = Report { chip, program, bits, cycles, scenes, asked };
    let (markdown, json) = report.write(&options.report)?;
    let faults = report.faults();
    faults.iter().for_each(|fault| complain(format_args!("not well: {fault}")));
    say(format_args!("{}\nreport: {} and {}", report.headline(), markdown.display(), json.display()))?;
    Ok(faults.is_empty())
}
