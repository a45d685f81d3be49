//! The command line of `cargo demo`.

use std::path::PathBuf;

use clap::Parser;
use double_pendulum::Method;
use double_pendulum::plan::Stepping;
use firmware::config::PROCESSOR;
use firmware::display::Controller;
use firmware::motion::Resources;
use firmware::scenes::{AnyScene, SceneName};

use crate::commands::out_file::check_writable;
use crate::console::cli::{Refused, choice};
use crate::emulator::boards::{BOARDS, Board, every_board};

/// Shows the double pendulum on a board's panel, live in the terminal, each frame compared with the host's own; a panel that the
/// host cannot see is redrawn from the numbers that the board sends.
#[derive(Clone, Debug, Parser)]
#[command(name = "cargo demo", after_help = after_help())]
pub struct DemoOptions {
    /// The board
    #[arg(long, value_name = "NAME", default_value = BOARDS[0].name,
          value_parser = choice(every_board(), |board| board.name))]
    pub board: &'static Board,
    /// Not an emulated board but the one at this serial port; `auto` finds it by its USB id
    #[arg(long, value_name = "PATH", conflicts_with = "board")]
    pub port: Option<String>,
    /// The scene [default: what the board plays, page when it is switched on]
    #[arg(long, value_name = "NAME", value_parser = choice(SceneName::ALL.iter().copied(), SceneName::name))]
    pub scene: Option<SceneName>,
    /// How the motion is computed; `plan` leaves it to the board [default: what the board does, plan when it is switched on]
    #[arg(long, value_name = "NAME",
          value_parser = choice([None].into_iter().chain(Method::DRAWN.iter().copied().map(Some)),
                                |method| method.map_or("plan", Method::name)))]
    pub method: Option<Asked>,
    /// The controller of the panel, kept until the board is switched off; `auto` identifies it [default: as it is]
    #[arg(long, value_name = "NAME",
          value_parser = choice([None].into_iter().chain(Controller::ALL.iter().copied().map(Some)),
                                |panel| panel.map_or("auto", Controller::name)))]
    pub panel: Option<Chosen>,
    /// Run without a terminal: as fast as it goes, repeatable bit for bit, with a summary at the end
    #[arg(long)]
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
}

/// The keys, what each scene shows, and examples.
fn after_help() -> String {
    let scenes = SceneName::ALL
        .iter()
        .map(|scene| format!("  {:12} {}\n", scene.name(), shows(*scene)));
    format!(
        "Keys: up/down mass ratio, left/right start angle, space restart, tab next scene, p pause, . step, ? help, q quit\n\n\
         Scenes:\n{}\n\
         A board in the hand: cargo demo --port /dev/ttyUSB0\n\
         Its picture is shifted or dark: cargo demo --port auto --panel sh1106, or ssd1306\n\
         Example without a terminal: cargo demo --scene butterfly --headless --seconds 10 --record butterfly.gif",
        scenes.collect::<String>()
    )
}

fn shows(scene: SceneName) -> &'static str {
    match scene {
        SceneName::Page => "the book's animation: a motion from 120 degrees, soon chaotic",
        SceneName::SmallLight => "both angles of a small oscillation, bob 2 light: figure 3",
        SceneName::SmallEqual => "the same of equal bobs: figure 4",
        SceneName::SmallHeavy => "the same, bob 2 heavy: figure 5",
        SceneName::Frequencies => "both normal frequencies over the mass ratio: figure 2",
        SceneName::Beats3To2 => "frequencies as 3 to 2: the curve of both angles closes",
        SceneName::Beats2To1 => "the same as 2 to 1",
        SceneName::Beats5To2 => "the same as 5 to 2",
        SceneName::Beats3To1 => "the same as 3 to 1",
        SceneName::Figure7 => "the right equations beside those misprinted in the book",
        SceneName::Butterfly => "two pendulums a millionth of a radian apart, until they part",
        SceneName::Upright => "straight up: which arithmetic lets it fall, and when",
        SceneName::Flips => "a map of all starts: how soon a rod turns over",
    }
}

/// A method, or none to leave it to the board's plan.
pub type Asked = Option<Method>;

/// A controller of the panel, or none to identify it.
pub type Chosen = Option<Controller>;

impl DemoOptions {
    /// Refuses what is known to fail before anything is built: files that cannot be written, a method that the scene does not use.
    pub fn check(&self) -> Result<(), Refused> {
        for (option, file) in [
            ("--record", &self.record),
            ("--screenshot", &self.screenshot),
        ] {
            file.as_deref()
                .map_or(Ok(()), |file| check_writable(option, file))?;
        }
        let first = self.port.is_none().then_some(SceneName::Page);
        self.scene
            .or(first)
            .map_or(Ok(()), |scene| self.check_method(scene))
    }

    pub fn check_method(&self, scene: SceneName) -> Result<(), Refused> {
        let Some(Some(method)) = self.method else {
            return Ok(());
        };
        let resources = Resources {
            processor: PROCESSOR,
            method: Some(method),
        };
        let refused = |why: &str| {
            Err(Refused::because(format_args!(
                "--method {method}: --scene {} {why}",
                scene.name()
            )))
        };
        let mut started = AnyScene::empty();
        match started
            .start(scene, &scene.first_settings(), &resources)
            .map(|_| started.report(0).stepping)
        {
            Ok(Some(Stepping { method: gone, .. })) if gone == method => Ok(()),
            Ok(_) => refused("has no use for it"),
            Err(_) => refused("cannot be computed so"),
        }
    }
}

/// A file whose name says what is written into it.
fn ends_in(kind: &str, file: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(file);
    let is_it = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case(kind));
    if is_it {
        Ok(path)
    } else {
        Err(format!(
            "write a file name that ends in .{kind}, the only format there is"
        ))
    }
}

/// The longest that a run may be, s of the board's time.
pub const MOST_SECONDS: f64 = 86_400.0;

fn seconds(text: &str) -> Result<f64, String> {
    let wrong = || format!("write a number of seconds greater than 0, at most {MOST_SECONDS}");
    text.parse()
        .ok()
        .filter(|seconds| *seconds > 0.0 && *seconds <= MOST_SECONDS)
        .ok_or_else(wrong)
}
