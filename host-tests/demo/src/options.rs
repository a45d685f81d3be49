//! The command line of `cargo demo`.
//!
//! The texts of [`DemoOptions`] are the help of the command. A field that is `None` leaves the
//! board's present choice.

use std::path::PathBuf;

use clap::{Parser, value_parser};
use double_pendulum::plan::Stepping;
use double_pendulum::{Method, Parameter};
use firmware::config::{GREATEST_SPEED, Processor, STM32F405};
use firmware::display::Controller;
use firmware::graphics::{Format, PanelName};
use firmware::motion::{Resources, Settings};
use firmware::scenes::{AnyScene, SceneName};

use super::motion::OwnMotion;
use boards::console::cli::{Refused, choice, choice_with_aliases};
use boards::console::number::Number;
use boards::{BOARDS, Board, PICO, every_board, pico_with};

/// Shows the double pendulum on a board's panel, live in the terminal, and compares each frame with
/// the host's own. For a real board the picture is rebuilt from the data it sends.
#[derive(Clone, Debug, Parser)]
#[command(name = "cargo demo", after_help = after_help())]
pub struct DemoOptions {
    /// The board
    #[arg(long, alias = "on", alias = "target", value_name = "NAME", default_value = BOARDS[0].name,
          value_parser = choice_with_aliases(every_board(), Board::names))]
    pub board: &'static Board,
    /// Use the real board at this serial port; `auto` takes the only one over USB
    #[arg(long, value_name = "PATH", conflicts_with = "board")]
    pub port: Option<String>,
    /// The scene [default: the board's current scene, page after power-on]
    #[arg(
        long,
        value_name = "NAME",
        value_parser = choice(SceneName::ALL.iter().copied(), SceneName::name),
    )]
    pub scene: Option<SceneName>,
    /// The method that computes the motion; `plan` lets the board choose [default: the board's
    /// current choice, plan after power-on]
    #[arg(long, value_name = "NAME",
          value_parser = choice([None].into_iter().chain(Method::DRAWN.iter().copied().map(Some)),
                                |method| method.map_or("plan", Method::name)))]
    pub method: Option<MethodChoice>,
    /// The panel. Of an OLED the controller, kept until the board is switched off; `auto` or `oled`
    /// identifies it [default: as it is]. The other panels are those of an emulated Pico
    #[arg(long, value_name = "NAME", value_parser = choice_with_aliases(panels(), PanelChoice::names))]
    pub panel: Option<PanelChoice>,
    /// Turn the panel's picture by 180 degrees, or back by 0; kept as --panel
    #[arg(long, value_name = "DEGREES",
          value_parser = choice([false, true], |is_turned| if is_turned { "180" } else { "0" }))]
    pub turn: Option<bool>,
    /// Dim the panel after ten minutes without a key, or not; kept as --panel [default: as it is,
    /// on after power-on]
    #[arg(long, value_name = "WHEN",
          value_parser = choice([true, false], |dims| if dims { "on" } else { "off" }))]
    pub dim: Option<bool>,
    /// What moves, in place of the scene's own motion.
    #[command(flatten)]
    pub motion: OwnMotion,
    /// Simulated time per real time, 0.01 to 4 [default: the board's current speed, 1 after
    /// power-on]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub speed: Option<Number>,
    /// Run without a terminal, at full speed, with the same result every time, and print a summary
    #[arg(long)]
    pub headless: bool,
    /// Duration in seconds of the board's clock [default: 10 if headless, else until q is pressed]
    #[arg(long, alias = "until", alias = "duration", value_name = "N", value_parser = seconds)]
    pub seconds: Option<f64>,
    /// Save the panel's pictures as an animation, 30 frames per second
    #[arg(long, value_name = "FILE.gif", value_parser = |file: &str| ends_in("gif", file))]
    pub record: Option<PathBuf>,
    /// Save the last picture of the panel
    #[arg(long, value_name = "FILE.png", value_parser = |file: &str| ends_in("png", file))]
    pub screenshot: Option<PathBuf>,
    /// The width and height of a pixel of the panel in these files, 1 to 16 [default: 3, which
    /// gives 384 x 192, and 2 for a colour panel]
    #[arg(long, value_name = "N", value_parser = value_parser!(u8).range(1..=16))]
    pub scale: Option<u8>,
}

fn after_help() -> String {
    let keys = KEYS
        .iter()
        .map(|(keys, meaning)| format!("  {keys:16} {meaning}\n"));
    let scenes = SceneName::ALL.iter().enumerate().map(|(place, scene)| {
        let key = scene_key(place);
        format!("  {key}  {:12} {}\n", scene.name(), shows(*scene))
    });
    format!(
        "Keys:\n{}\nScenes, each with its key:\n{}\n\
         Examples:\n  \
         cargo demo --angles 90,45 --degrees --masses 1,3 --lengths 1,0.7 --speed 1/2\n  \
         cargo demo --port /dev/ttyUSB0      # a real board\n  \
         cargo demo --port auto --panel sh1106   # for a picture shifted or dark; or ssd1306\n  \
         cargo demo --scene butterfly --headless --seconds 10 --record butterfly.gif",
        keys.collect::<String>(),
        scenes.collect::<String>()
    )
}

/// The keys of the live view. Keys in one entry are separated by ", "; their effects are in the
/// same order.
pub const KEYS: [(&str, &str); 10] = [
    ("up, down", "mass ratio m2/m1: next larger, next smaller"),
    ("left, right", "start angle of both rods by 1 degree"),
    ("space, Enter", "restart; a pause stays"),
    ("tab, n", "next scene; shift-tab, N: previous scene"),
    ("1-9, a-d", "scene by number"),
    ("p", "pause, continue"),
    (".", "one tick of 1/60 s, then pause"),
    ("-, +", "slower, faster"),
    ("?", "help; again: its second page; Esc closes it"),
    ("q, ctrl-C", "quit"),
];

pub fn scene_key(place: usize) -> char {
    u32::try_from(place + 1)
        .ok()
        .and_then(|number| char::from_digit(number, 36))
        .unwrap_or(' ')
}

pub fn scene_of_key(key: char) -> Option<SceneName> {
    let place = (0..SceneName::ALL.len()).find(|place| scene_key(*place) == key)?;
    SceneName::ALL.get(place).copied()
}

pub fn shows(scene: SceneName) -> &'static str {
    match scene {
        SceneName::Page => "the animation of math24.net: from 120 degrees, soon chaotic",
        SceneName::SmallLight => "both angles of a small oscillation with a light bob 2 (figure 3)",
        SceneName::SmallEqual => "both angles of a small oscillation with equal bobs (figure 4)",
        SceneName::SmallHeavy => "both angles of a small oscillation with a heavy bob 2 (figure 5)",
        SceneName::Frequencies => "both normal frequencies over the mass ratio (figure 2)",
        SceneName::Beats3To2 => "frequencies in the ratio 3 to 2: the curve of both angles closes",
        SceneName::Beats2To1 => "frequencies in the ratio 2 to 1: the curve of both angles closes",
        SceneName::Beats5To2 => "frequencies in the ratio 5 to 2: the curve of both angles closes",
        SceneName::Beats3To1 => "frequencies in the ratio 3 to 1: the curve of both angles closes",
        SceneName::Figure7 => "the right equations next to those misprinted on math24.net (`book`)",
        SceneName::Butterfly => "two pendulums a millionth of a radian apart, until they part",
        SceneName::Upright => {
            "from the f32 nearest to pi, 180.000005 degrees: when it falls in plain and compensated f32"
        }
        SceneName::Flips => "a map of all starts: the time until a rod turns over",
    }
}

pub type MethodChoice = Option<Method>;

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PanelChoice {
    /// `None` lets the board identify it.
    Oled(Option<Controller>),
    Colour(PanelName),
}

impl PanelChoice {
    fn names(self) -> Vec<&'static str> {
        match self {
            Self::Oled(None) => vec!["auto", PanelName::Oled.name()],
            Self::Oled(Some(controller)) => vec![controller.name()],
            Self::Colour(panel) => vec![panel.name()],
        }
    }
}

fn panels() -> impl Iterator<Item = PanelChoice> {
    let controllers = [None]
        .into_iter()
        .chain(Controller::ALL.iter().copied().map(Some));
    let colour = PanelName::ALL
        .iter()
        .copied()
        .filter(|panel| panel.format().is_large());
    controllers
        .map(PanelChoice::Oled)
        .chain(colour.map(PanelChoice::Colour))
}

impl DemoOptions {
    /// Refuses requests that are known to fail before anything is built. For a board at a port
    /// without `--scene` the scene is not known yet.
    pub fn check(&self) -> Result<(), Refused> {
        self.speed()?;
        if let Some(PanelChoice::Colour(panel)) = self.panel
            && (self.port.is_some() || *self.board != PICO)
        {
            return Err(Refused::because(format_args!(
                "--panel {}: a colour panel is built into the program of an emulated Pico; add \
                 --board pico, or flash a real one by cargo pico --panel {}",
                panel.name(),
                panel.name()
            )));
        }
        let first = self.port.is_none().then_some(SceneName::Page);
        match self.scene.or(first) {
            Some(scene) => self.start(scene).map(|_| ()),
            None => Ok(()),
        }
    }

    /// Returns the requested speed. The board stores it in hundredths.
    pub fn speed(&self) -> Result<Option<f64>, Refused> {
        let Some(speed) = &self.speed else {
            return Ok(None);
        };

        let least = 0.01;
        let most = f64::from(GREATEST_SPEED);
        if (least..=most).contains(&speed.value()) {
            Ok(Some(speed.value()))
        } else {
            Err(Refused::because(format_args!(
                "--speed {speed}: write a number from {least} to {most}"
            )))
        }
    }

    /// Returns the settings to start `scene` with, or `None` for its own ([`OwnMotion::settings`]).
    /// For a board at a port the fastest processor class is assumed, so the board may still refuse
    /// them.
    pub fn start(&self, scene: SceneName) -> Result<Option<Settings>, Refused> {
        let own = self.motion.settings(scene, self.processor())?;
        let settings = own.unwrap_or_else(|| scene.first_settings());
        if let Some(Some(method)) = self.method {
            usable(method, scene, &settings, self.processor()).map_err(|reason| {
                Refused::because(format_args!(
                    "--method {method}: {reason}; leave --method out, or take another scene"
                ))
            })?;
        }
        Ok(own)
    }

    pub fn board(&self) -> Board {
        match self.panel {
            Some(PanelChoice::Colour(panel)) => pico_with(panel),
            _ => *self.board,
        }
    }

    pub fn scale(&self) -> usize {
        let default = if self.board().panel.format().is_large() {
            2
        } else {
            3
        };
        self.scale.map_or(default, usize::from)
    }

    /// A board at a port reports its class only later, so the fastest class is assumed.
    fn processor(&self) -> Processor {
        if self.port.is_some() {
            STM32F405
        } else {
            self.board.processor()
        }
    }
}

/// Starts the scene as a trial, and refuses a method that it does not use with these settings.
pub fn usable(
    method: Method,
    scene: SceneName,
    settings: &Settings,
    processor: Processor,
) -> Result<(), String> {
    let resources = Resources {
        processor,
        method: Some(method),
        format: Format::OLED,
    };
    let mut started = AnyScene::empty();
    let stepping = started
        .start(scene, settings, &resources)
        .map(|_| started.report(0).stepping);

    let scene = scene.name();
    match stepping {
        Ok(Some(stepping)) if stepping.method == method => Ok(()),
        Ok(Some(Stepping { method, .. })) => Err(format!("scene {scene} always uses {method}")),
        Ok(None) => Err(format!("scene {scene} has no choice of methods")),
        Err(error) if error.parameter() == Parameter::Cost => {
            Err(format!("too slow for scene {scene} on this chip"))
        }
        Err(error) if error.parameter() == Parameter::Dt => {
            Err(format!("its steps are too long for scene {scene}"))
        }
        Err(error) => Err(format!("cannot compute scene {scene} ({error})")),
    }
}

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

/// A day, in seconds of the board's clock.
pub const MOST_SECONDS: f64 = 86_400.0;

fn seconds(text: &str) -> Result<f64, String> {
    let wrong = || format!("write a number of seconds greater than 0, at most {MOST_SECONDS}");
    text.parse()
        .ok()
        .filter(|seconds| *seconds > 0.0 && *seconds <= MOST_SECONDS)
        .ok_or_else(wrong)
}
