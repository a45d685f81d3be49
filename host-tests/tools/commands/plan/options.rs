//! The scene to plan, as the command line describes it.
//!
//! Without options, the display is 64 pixels high, the scene is 30 s long and has 60 frames a
//! second, and the chip is the first of [`CHIPS`]. Both rods together are half as long as the
//! display is high, so that half a pixel is (l1 + l2)/height, m; a built-in scene has its own size.
//! The numbers are checked by [`SceneOptions::plan`]: the height must be more than 0 and at most
//! 1e6 pixels, the duration more than 0 and at most (2^32 - 1)/rate s.

use anyhow::{Context, bail, ensure};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Parser, value_parser};
use double_pendulum::Method;
use double_pendulum::plan::{Limit, Plan, PlanError, Problem, Search, Stepping};
use firmware::config::{CORTEX_M0PLUS, CORTEX_M3, CORTEX_M4F, Processor, STM32F405};
use firmware::motion::half_pixel;
use firmware::scenes::SceneName;

use crate::commands::simulate::{StartOptions, check_turns};
use console::cli::choice;
use console::number::Number;
use emulator::boards::every_board;
use emulator::host::Show;

/// The method of the scenes that show the linear motion.
const LINEAR: Stepping = Stepping {
    method: Method::ClosedFormF32,
    steps: 1,
};

/// Advances a search to its end.
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
    /// A built-in scene, with the f32 values that the boards start it with (excludes --angles,
    /// --velocities, --degrees, --masses, --lengths, --gravity, --height, --duration and --rate)
    #[arg(
        long,
        value_name = "NAME",
        value_parser = choice(SceneName::ALL.iter().copied(), SceneName::name),
        conflicts_with_all = [
            "masses", "lengths", "gravity", "angles", "velocities", "degrees", "height",
            "duration", "rate",
        ],
    )]
    pub scene: Option<SceneName>,
    /// Height of the display, pixels, at most 1e6; both rods together have half this length
    #[arg(
        long,
        value_name = "PIXELS",
        default_value = "64",
        allow_hyphen_values = true
    )]
    pub height: Number,
    /// Duration of the scene, s
    #[arg(
        long,
        value_name = "T",
        default_value = "30",
        allow_hyphen_values = true
    )]
    pub duration: Number,
    /// Frames per second, 1 to 65535
    #[arg(
        long,
        value_name = "N",
        default_value_t = 60,
        value_parser = value_parser!(u16).range(1..),
    )]
    pub rate: u16,
    /// The chip that computes it, or the board with this chip
    #[arg(
        long,
        visible_alias = "on",
        value_name = "CHIP",
        default_value = CHIPS[0].name,
        value_parser = chip(),
    )]
    pub target: Chip,
}

/// The largest height of the display, pixels. Half a pixel is then eight times the rounding of the
/// rods' directions.
const HIGHEST: f64 = 1e6;

impl SceneOptions {
    /// Returns the scene with its plan, or with the limit that forbids any plan. Lengths are in m,
    /// angles in rad, times in s, costs in cycles. The tolerance is half a pixel. An error is one
    /// line that names the option and the value; it is caused by a number out of range, also an
    /// angle of more than 2^26 rad, by a pendulum that the kernel refuses, or by a built-in scene
    /// without a motion to plan.
    ///
    /// The plan of a [linear](SceneName::is_linear) scene always has the closed form. Its horizon
    /// is the time until which the linear motion is within half a pixel of the exact motion.
    pub fn plan(&self) -> anyhow::Result<(Problem, Result<Plan, Limit>)> {
        // A built-in scene defines the whole problem; otherwise the options do.
        let problem = self
            .scene
            .map_or_else(|| self.given(), |name| self.of_scene(name))?;
        let Processor { costs, .. } = &self.target.processor;
        let budget = self.target.processor.budget(&problem);

        // A linear scene always has the same method, so only its horizon is evaluated.
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

    /// Returns true if the built-in scene of the options shows the linear motion, on purpose
    /// ([`SceneName::is_linear`]); false without a built-in scene.
    pub fn is_linear(&self) -> bool {
        self.scene.is_some_and(SceneName::is_linear)
    }

    /// Returns the problem that a board of this class plans when it starts the scene.
    fn of_scene(&self, name: SceneName) -> anyhow::Result<Problem> {
        let settings = name.first_settings();
        // The board's own code starts the scene, and so determines the size of the drawing.
        let show = Show::on(self.target.processor, name, &settings)?;
        let planned = show.player.plan().with_context(|| {
            format!(
                "--scene {}: has no motion to plan; choose another scene, as in --scene page",
                name.name()
            )
        })?;
        Ok(settings.problem(planned.height))
    }

    /// Returns the problem of the options, without a built-in scene.
    fn given(&self) -> anyhow::Result<Problem> {
        let height = &self.height;
        ensure!(
            height.is_positive(),
            "--height {height}: must be greater than zero"
        );
        ensure!(
            height.value() <= HIGHEST,
            "--height {height}: more than {HIGHEST}, finer than the rods' directions in f32"
        );
        let start = self.start.motion();
        // A scene starts from `f64` numbers, also for a method in 32 bits.
        check_turns(start.angles(), Method::Rk4F64)?;
        Ok(Problem {
            pendulum: self.start.parameters(),
            start,
            tolerance: half_pixel(&self.start.parameters(), height.value()),
            duration: self.duration.value(),
            rate: self.rate,
        })
    }
}

/// A chip, with the data that a plan needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chip {
    /// The name on the command line.
    pub name: &'static str,
    /// The core and its clock, for people.
    pub title: &'static str,
    /// The frequency of its clock, Hz.
    pub clock: f32,
    /// The costs of its steps and its budgets, in cycles.
    pub processor: Processor,
}

/// Reads the name of a chip, or of a board with such a chip.
fn chip() -> impl TypedValueParser<Value = Chip> {
    let boards = |chip: &Chip| {
        let boards = every_board().filter(|board| board.processor() == chip.processor);
        boards.map(|board| board.name).collect::<Vec<_>>()
    };
    let names = CHIPS.map(|chip| PossibleValue::new(chip.name).aliases(boards(&chip)));
    PossibleValuesParser::new(names).try_map(move |name| {
        CHIPS
            .into_iter()
            .find(|chip| chip.name == name || boards(chip).contains(&&*name))
            .ok_or("unknown")
    })
}

/// Every chip; the first is the default. They are `m3`, the LM3S6965 without a floating-point unit
/// at 50 MHz; `m4f`, the STM32F405 with a floating-point unit for `f32` at 168 MHz; `slow-m4f`, a
/// Cortex-M4F with the same unit at 25 MHz; and `pico`, the chip of the
/// Raspberry Pi Pico at 125 MHz, whose products of two integers have only 32 bits. On the command
/// line the name of a board with the chip is accepted, too.
pub const CHIPS: [Chip; 4] = [
    Chip {
        name: "m3",
        title: "Cortex-M3 at 50 MHz",
        clock: 50e6,
        processor: CORTEX_M3,
    },
    Chip {
        name: "m4f",
        title: "Cortex-M4F at 168 MHz",
        clock: 168e6,
        processor: STM32F405,
    },
    Chip {
        name: "slow-m4f",
        title: "Cortex-M4F at 25 MHz",
        clock: 25e6,
        processor: CORTEX_M4F,
    },
    Chip {
        name: "pico",
        title: "Cortex-M0+ at 125 MHz",
        clock: 125e6,
        processor: CORTEX_M0PLUS,
    },
];
