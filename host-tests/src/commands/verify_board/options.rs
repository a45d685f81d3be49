//! The command line of `cargo verify-board`.

use std::path::PathBuf;

use clap::{Parser, value_parser};
use firmware::config::BAUD;

/// Verifies a board at a serial port: the bits of every arithmetic and scene beside the host's, the cycles of every
/// arithmetic, the times of the scenes, its buttons and its panel; and writes a report.
#[derive(Clone, Debug, Parser)]
#[command(name = "cargo verify-board", after_help = "Example: cargo verify-board --port auto --report feather")]
pub struct Options {
    /// The serial port; `auto` is the only one over USB
    #[arg(long, value_name = "PATH")]
    pub port: String,
    /// Bits per second of that port
    #[arg(long, value_name = "N", default_value_t = BAUD, value_parser = value_parser!(u32).range(1..))]
    pub baud: u32,
    /// Do not ask about buttons and panel
    #[arg(long)]
    pub no_questions: bool,
    /// Where the report goes: FILE.md and FILE.json
    #[arg(long, value_name = "FILE", default_value = "board-report")]
    pub report: PathBuf,
}
