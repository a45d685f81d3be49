//! The command line of `cargo demo`.

use std::path::PathBuf;

use clap::Parser;
use firmware::scenes::SceneName;

use crate::console::cli::choice;
use crate::emulator::boards::{BOARDS, Board};

/// Shows the double pendulum on an emulated board's panel, live in the terminal.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "cargo demo",
    after_help = "Keys: up/down mass ratio, left/right start angle, space restart, tab next scene, p pause, . step, q quit\n\n\
                  Example without a terminal: cargo demo --scene butterfly --headless --seconds 10 --record butterfly.gif"
)]
pub struct Options {
    /// The board
    #[arg(long, value_name = "NAME", default_value = BOARDS[0].name,
          value_parser = choice(BOARDS.iter().filter(|board| board.has_panel), |board| board.name))]
    pub board: &'static Board,
    /// The scene
    #[arg(long, value_name = "NAME", default_value = SceneName::Page.name(), 
          value_parser = choice(SceneName::ALL.iter().copied(), SceneName::name))]
    pub scene: SceneName,
    /// Run without a terminal: as fast as it goes, repeatable to the bit, with a summary at the end
    #[arg(long, conflicts_with = "window")]
    pub headless: bool,
    /// How long, in seconds by the board's clock [default: 10 when headless, else until q is pressed]
    #[arg(long, value_name = "N", value_parser = seconds)]
    pub seconds: Option<f64>,
    /// Save what the panel showed as an animation, 30 frames per second
    #[arg(long, value_name = "FILE.gif", value_parser = |file: &str| ends_in("gif", file))]
    pub record: Option<PathBuf>,
    /// Save the last screenshot of the panel
    #[arg(long, value_name = "FILE.png", value_parser = |file: &str| ends_in("png", file))]
    pub screenshot: Option<PathBuf>,
    /// Open QEMU's own window as well
    #[arg(long)]
    pub window: bool,
}

/// A file whose name says what is written into it.
fn ends_in(kind: &str, file: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(file);
    let is_it = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(kind));
    if is_it { Ok(path) } else { Err(format!("write a file name that ends in .{kind}, the only format there is")) }
}

/// A length of time that a recording may have.
fn seconds(text: &str) -> Result<f64, &'static str> {
    const GREATEST: f64 = 86_400.0;
    let wrong = "write a number of seconds greater than 0, at most 86400";
    text.parse().ok().filter(|seconds| *seconds > 0.0 && *seconds <= GREATEST).ok_or(wrong)
}
