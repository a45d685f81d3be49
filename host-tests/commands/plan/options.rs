//! The scene to plan, as the command line describes it.

use anyhow::{Context, bail, ensure};
use clap::{Parser, value_parser};
use double_pendulum::Method;
use double_pendulum::plan::{Limit, Plan, PlanError, Problem, Search, Stepping};
use firmware::config::{CORTEX_M0PLUS, CORTEX_M3, CORTEX_M4F, Processor, STM32F405};
use firmware::graphics::PanelName;
use firmware::motion::half_pixel;
use firmware::scenes::SceneName;

use crate::simulate::StartOptions;
use boards::console::cli::{choice, choice_with_aliases};
use boards::console::number::Number;
use boards::host::Show;

/// The method of the scenes that show the linear motion.
const LINEAR: Stepping = Stepping {
    method: Method::ClosedFormF32,
    steps: 1,
};

fn finish(mut search: Search) -> Result<Plan, PlanError> {
    loop {
        if let Some(plan) = search.advance(f32::INFINITY)? {
            return Ok(plan);
        }
    }
}

/// A scene, and the chip that computes it.
#[derive(Debug, Parser)]
pub struct SceneOptions {
    /// What moves, without `--scene`.
    #[command(flatten)]
    pub start: StartOptions,
    /// A built-in scene, as the boards start it (excludes --angles,
    /// --velocities, --degrees, --masses, --lengths, --gravity, --height, --seconds and --rate)
    #[arg(
        long,
        value_name = "NAME",
        value_parser = choice(SceneName::ALL.iter().copied(), SceneName::name),
        conflicts_with_all = [
            "masses", "lengths", "gravity", "angles", "velocities", "degrees", "height",
            "seconds", "rate",
        ],
    )]
    pub scene: Option<SceneName>,
    /// Height of the display, pixels, at most 1e6; both rods together have half this length
    /// [default: that of the panel]
    #[arg(
        long,
        value_name = "PIXELS",
        conflicts_with = "panel",
        allow_hyphen_values = true
    )]
    pub height: Option<Number>,
    /// The panel, whose pixels are the tolerance, as in cargo pico --panel
    #[arg(
        long,
        value_name = "NAME",
        default_value = PanelName::Oled.name(),
        value_parser = choice(PanelName::ALL.iter().copied(), PanelName::name),
    )]
    pub panel: PanelName,
    /// Duration of the scene, s
    #[arg(
        long,
        alias = "duration",
        alias = "until",
        value_name = "N",
        default_value = "30",
        allow_hyphen_values = true
    )]
    pub seconds: Number,
    /// Frames per second, 1 to 65535
    #[arg(
        long,
        value_name = "N",
        default_value_t = 60,
        value_parser = value_parser!(u16).range(1..),
    )]
    pub rate: u16,
    /// The board that computes it
    #[arg(
        long = "board",
        alias = "target",
        alias = "on",
        value_name = "NAME",
        default_value = CHIPS[0].board,
        value_parser = choice_with_aliases(CHIPS, |chip| vec![chip.board, chip.name]),
    )]
    pub target: Chip,
}

/// The largest height of the display, pixels. Half a pixel is then eight times the rounding of the
/// rods' directions.
const HIGHEST: f64 = 1e6;

impl SceneOptions {
    /// Returns the scene with its plan, or with the limit that forbids any plan. The tolerance is
    /// half a pixel. The plan of a linear scene has the closed form and the horizon of the linear
    /// motion.
    pub fn plan(&self) -> anyhow::Result<(Problem, Result<Plan, Limit>)> {
        let problem = self
            .scene
            .map_or_else(|| self.given(), |name| self.of_scene(name))?;
        let Processor { costs, .. } = &self.target.processor;
        let budget = self.target.processor.budget(&problem);

        let found = if self.is_linear() {
            Search::of(LINEAR, &problem, costs, &budget).and_then(finish)
        } else {
            Plan::search(&problem, costs, &budget)
        };
        match found {
            Ok(plan) => Ok((problem, Ok(plan))),
            Err(PlanError::NoMethod { limit, .. }) => Ok((problem, Err(limit))),
            Err(PlanError::Refused(error)) => bail!(self.start.refusal(&error, "the scene")),
            Err(error) => bail!("the scene: {error}"),
        }
    }

    /// Returns the words for the end of the scene. Only a motion of the user's own can be longer.
    pub fn end(&self) -> &'static str {
        match self.scene {
            Some(_) => "the end",
            None => "the end; longer with --seconds",
        }
    }

    pub fn is_linear(&self) -> bool {
        self.scene.is_some_and(SceneName::is_linear)
    }

    fn of_scene(&self, name: SceneName) -> anyhow::Result<Problem> {
        let settings = name.first_settings();
        // The board's own code starts the scene, and so determines the size of the drawing.
        let format = self.panel.format();
        let show = Show::in_format(format, self.target.processor, name, &settings)?;
        let planned = show.player.plan().with_context(|| {
            format!(
                "--scene {}: has no motion to plan; choose another scene, as in --scene page",
                name.name()
            )
        })?;
        Ok(settings.problem(planned.height))
    }

    fn given(&self) -> anyhow::Result<Problem> {
        let mut pixels = f64::from(self.panel.format().height);
        if let Some(height) = &self.height {
            pixels = height.value();
            ensure!(pixels > 0.0, "--height {height}: must be greater than zero");
            ensure!(
                pixels <= HIGHEST,
                "--height {height}: more than {HIGHEST}, finer than the rods' directions in f32"
            );
        }
        Ok(Problem {
            pendulum: self.start.parameters(),
            start: self.start.motion(),
            tolerance: half_pixel(&self.start.parameters(), pixels),
            duration: self.seconds.value(),
            rate: self.rate,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chip {
    pub board: &'static str,
    pub name: &'static str,
    /// The core and its clock, for people.
    pub title: &'static str,
    pub clock: f32,
    pub processor: Processor,
}

pub const CHIPS: [Chip; 4] = [
    Chip {
        board: "lm3s6965evb",
        name: "m3",
        title: "Cortex-M3 at 50 MHz",
        clock: 50e6,
        processor: CORTEX_M3,
    },
    Chip {
        board: "stm32f405",
        name: "m4f",
        title: "Cortex-M4F at 168 MHz",
        clock: 168e6,
        processor: STM32F405,
    },
    Chip {
        board: "lm3s6965evb-m4",
        name: "slow-m4f",
        title: "Cortex-M4F at 25 MHz",
        clock: 25e6,
        processor: CORTEX_M4F,
    },
    Chip {
        board: "pico",
        name: "pico",
        title: "Cortex-M0+ at 125 MHz",
        clock: 125e6,
        processor: CORTEX_M0PLUS,
    },
];
