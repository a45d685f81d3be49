//! What a scene is, and the catalogue: a row each gives the name, the scene and what it starts with.

mod beats;
mod butterfly;
pub mod flips;
mod frequencies;
mod pendulums;
mod small;

pub use flips::Flips;

use double_pendulum::plan::Stepping;
use double_pendulum::{Error, State};

use crate::config::{GREATEST_ANGLE, TICK_RATE};
use crate::graphics::{Anchor, Canvas, FadeLayer, Fading, label, text};
use crate::motion::{Horizon, Resources, Settings, Simulation};

/// Something to watch: it starts from settings, moves tick by tick and is drawn when there is time for it.
pub trait Scene: Sized {
    const FADING: Fading = Fading::TRACE;

    /// At the start, and the height of a display, pixels, on which two rods as long as those shown reach from the middle to the edge;
    /// where angles are shown as curves, a rod is a radian long; `None` if nothing is shown that can be planned. The kernel's error if
    /// the settings describe no pendulum, or none that this scene can show.
    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error>;

    /// Advances by one tick, to so many `ticks` after the start, and adds to the ink what stays. The frame does not depend on
    /// which of those before were drawn.
    fn tick(&mut self, ticks: u64, ink: &mut FadeLayer);

    /// Draws over the ink; `report` is what it has just been told in numbers, which need not be found twice.
    fn draw(&self, report: &Report, canvas: &mut Canvas);

    fn report(&self, ticks: u64) -> Report {
        Report::at(ticks)
    }

    /// The motion whose method and steps the plan may change.
    fn planned(&mut self) -> Option<&mut Simulation> {
        None
    }

    /// Returns true if no method resolves the motion at a cost that a frame can pay. Then the scene
    /// must not advance.
    fn is_too_fast(&self) -> bool {
        false
    }
}

/// The smallest energy error that `f64` can show: the energy is a sum of some 20 rounded numbers.
pub const LEAST_ENERGY_ERROR: f32 = 4e-15;

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Report {
    /// Ticks of 1/60 s since the start.
    pub step: u64,
    /// Simulated time since the start, s.
    pub time: f64,
    /// The canonical state of the first pendulum shown, turns counted; zeros where none moves.
    pub state: State<f32>,
    /// (E - E0)/(E0 - Emin) of that pendulum as it is computed, before its numbers are rounded for
    /// this report. Less than [`LEAST_ENERGY_ERROR`] either way is rounding of the energy itself.
    pub energy_error: f32,
    pub horizon: Horizon,
    /// What it is computed by; `None` where no motion is.
    pub stepping: Option<Stepping>,
}

impl Report {
    /// Of a figure in which no pendulum moves.
    fn at(ticks: u64) -> Self {
        Self {
            step: ticks,
            time: time(ticks),
            ..Self::default()
        }
    }

    /// Of a scene whose first pendulum is `simulation`.
    #[inline(never)] // no second copy
    pub fn of(simulation: &Simulation) -> Self {
        let motion = &simulation.motion;
        Self {
            state: motion.rounded_state(),
            energy_error: simulation.energy.error(motion),
            stepping: Some(motion.stepping()),
            ..Self::at(motion.frame())
        }
    }
}

/// The simulated time after so many ticks, s.
fn time(ticks: u64) -> f64 {
    ticks as f64 / f64::from(TICK_RATE)
}

/// Writes the time and until when the frame can be trusted; the time stands out once it is known that it no longer can.
fn draw_clock(canvas: &mut Canvas, report: &Report, time_at: Anchor, trust_at: Anchor) {
    let &Report { time, horizon, .. } = report;
    let shown = label::time(time);
    if horizon.is_past(time) {
        text::write_on(canvas, &shown, time_at, text::MARKED);
    } else {
        text::write(canvas, &shown, time_at);
    }
    text::write(canvas, &horizon.label(), trust_at);
}

macro_rules! catalogue {
    ($($row:ident = $name:literal, $scene:ty, $first:expr;)*) => {
        choice! {
            SceneName { $($row = $name;)* }
        }

        impl SceneName {
            /// What it starts with when it is chosen.
            pub fn first_settings(self) -> Settings {
                match self { $(Self::$row => $first,)* }
            }
        }

        #[expect(clippy::large_enum_variant, reason = "without a heap there is nowhere else to keep it")]
        #[derive(Clone, Debug)]
        pub enum AnyScene { $($row($scene),)* }

        impl AnyScene {
            /// Starts the scene `name` in the place of this one, and its height; if it cannot show `settings`, this one goes on.
            pub fn start(&mut self, name: SceneName, settings: &Settings, resources: &Resources) -> Result<Option<f32>, Error> {
                match name { $(SceneName::$row => self.become_one(settings, resources, Self::$row),)* }
            }

            /// As [`Scene::tick`]; the ink, which was clear at the start, fades.
            pub fn tick(&mut self, ticks: u64, ink: &mut FadeLayer) {
                let fading = match self { $(Self::$row(scene) => { scene.tick(ticks, ink); <$scene>::FADING })* };
                ink.fade(fading);
            }

            /// Draws the whole frame over what was there; `report` is the scene's, as of now.
            pub fn draw(&self, report: &Report, ink: &FadeLayer, canvas: &mut Canvas) {
                canvas.clone_from(&ink.frame);
                match self { $(Self::$row(scene) => scene.draw(report, canvas),)* }
            }

            pub fn planned(&mut self) -> Option<&mut Simulation> {
                match self { $(Self::$row(scene) => scene.planned(),)* }
            }

            /// As [`Scene::is_too_fast`].
            pub fn is_too_fast(&self) -> bool {
                match self { $(Self::$row(scene) => scene.is_too_fast(),)* }
            }

            pub fn report(&self, ticks: u64) -> Report {
                match self { $(Self::$row(scene) => scene.report(ticks),)* }
            }
        }
    };
}

catalogue! {
    Page = "page", pendulums::Page, Settings::default();
    SmallLight = "small-0.2", small::Small, small::example(0.2);
    SmallEqual = "small-1", small::Small, small::example(1.0);
    SmallHeavy = "small-5", small::Small, small::example(5.0);
    Frequencies = "frequencies", frequencies::Frequencies, Settings::default();
    Beats3To2 = "beats-3-2", beats::Beats, beats::closing(25.0 / 144.0);
    Beats2To1 = "beats-2-1", beats::Beats, beats::closing(9.0 / 16.0);
    Beats5To2 = "beats-5-2", beats::Beats, beats::closing(441.0 / 400.0);
    Beats3To1 = "beats-3-1", beats::Beats, beats::closing(16.0 / 9.0);
    Figure7 = "figure-7", pendulums::Figure7, pendulums::figure_7();
    Butterfly = "butterfly", butterfly::Butterfly, Settings::default();
    Upright = "upright", pendulums::Upright, Settings::equal_rods(1.0, GREATEST_ANGLE);
    Flips = "flips", flips::Flips, Settings::default();
}

impl AnyScene {
    /// An empty figure, until a scene is started in its place.
    pub fn empty() -> Self {
        Self::Frequencies(frequencies::Frequencies::default())
    }

    #[inline(never)] // the scenes of all the catalogue would stand side by side on the stack of who chooses one
    fn become_one<S: Scene>(
        &mut self,
        settings: &Settings,
        resources: &Resources,
        one: fn(S) -> Self,
    ) -> Result<Option<f32>, Error> {
        let (scene, height) = S::new(settings, resources)?;
        *self = one(scene);
        Ok(height)
    }
}

impl SceneName {
    /// Whether it shows a motion, which starts from two angles.
    pub fn has_angles(self) -> bool {
        !matches!(self, Self::Frequencies | Self::Flips)
    }

    /// Returns true if the scene shows the linear motion, on purpose, and not the exact one.
    pub fn is_linear(self) -> bool {
        matches!(self, Self::SmallLight | Self::SmallEqual | Self::SmallHeavy)
    }

    /// The next one in the catalogue; after the last the first.
    pub fn next(self) -> Self {
        self.turned(1)
    }

    /// The one before; before the first the last.
    pub fn previous(self) -> Self {
        self.turned(Self::ALL.len() - 1)
    }

    fn turned(self, by: usize) -> Self {
        let place = Self::ALL
            .iter()
            .position(|&name| name == self)
            .unwrap_or_default();
        Self::ALL
            .iter()
            .copied()
            .cycle()
            .nth(place + by)
            .unwrap_or(self)
    }
}
