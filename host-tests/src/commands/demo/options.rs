//! The command line of `cargo demo`.

use std::path::PathBuf;

use clap::Parser;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use firmware::scenes::SceneName;

use crate::emulator::boards::{BOARDS, Board};

/// Shows the double pendulum on an emulated board's panel, live in the terminal.
#[derive(Clone, Debug, Parser)]
#[command(
    name = "cargo demo",
    after_help = "keys: up/down mass ratio, left/right start angle, space restart, tab next scene, p pause, . step, q quit"
)]
pub struct Options {
    /// The board
    #[arg(long, default_value = BOARDS[0].name, value_parser = board())]
    pub board: &'static Board,
    /// The scene
    #[arg(long, value_name = "NAME", default_value = SceneName::Page.name(), value_parser = scene())]
    pub scene: SceneName,
    /// Run without a terminal: as fast as it goes, repeatable to the bit, with a summary at the end
    #[arg(long, conflicts_with = "window")]
    pub headless: bool,
    /// How long, in seconds by the board's clock [default: 10 when headless, else until q is pressed]
    #[arg(long, value_name = "N", value_parser = seconds)]
    pub seconds: Option<f64>,
    /// Save what the panel showed as an animation, 30 frames per second
    #[arg(long, value_name = "FILE.gif")]
    pub record: Option<PathBuf>,
    /// Save the last screenshot of the panel
    #[arg(long, value_name = "FILE.png")]
    pub screenshot: Option<PathBuf>,
    /// Open QEMU's own window as well
    #[arg(long)]
    pub window: bool,
}

/// The boards that have a panel to show.
fn board() -> impl TypedValueParser<Value = &'static Board> {
    let with_panel = || BOARDS.iter().filter(|board| board.has_panel);
    PossibleValuesParser::new(with_panel().map(|board| board.name))
        .try_map(move |name| with_panel().find(|board| board.name == name).ok_or("it has no panel"))
}

/// The catalogue of the firmware.
fn scene() -> impl TypedValueParser<Value = SceneName> {
    PossibleValuesParser::new(SceneName::ALL.iter().map(|scene| scene.name()))
        .try_map(|name| SceneName::from_name(&name).ok_or("there is no such scene"))
}

/// A length of time that a recording may have.
fn seconds(text: &str) -> Result<f64, &'static str> {
    const GREATEST: f64 = 86_400.0;
    let wrong = "write a number of seconds greater than 0, at most 86400";
    text.parse().ok().filter(|seconds| *seconds > 0.0 && *seconds <= GREATEST).ok_or(wrong)
}
