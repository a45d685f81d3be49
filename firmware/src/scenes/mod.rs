//! The trait of all scenes, and the catalogue. Each row of the catalogue contains a name, a scene
//! and its initial settings.
//!
//! To add a scene:
//!
//! 1. Write a type with the trait [`Scene`], as in `pendulums.rs`, and the last row of the
//!    `catalogue!`, because its place is its number on the link; name it in the list there. The
//!    compiler names the other places, such as its description in
//!    `host-tests/demo/src/options.rs`. If it shows a motion, add it to `OTHERS` in
//!    `host-tests/tests/firmware/sweep.rs`.
//! 2. `BLESS=1 cargo test -p host-tests --test firmware -- scenes:: golden:: link::` makes its stored
//!    files, and `cargo figures --animations` its picture.
//! 3. Run these modules and `sweep::` without `BLESS`, and `--test boards all_scenes::`.

mod beats;
mod butterfly;
pub mod flips;
mod frequencies;
mod pendulums;
mod small;
mod too_fast;

pub use flips::Flips;
pub use too_fast::too_fast;

use double_pendulum::plan::{Costs, Stepping};
use double_pendulum::{Error, State};

use crate::config::{GREATEST_ANGLE, TICK_RATE};
use crate::graphics::{Anchor, Canvas, Fading, Format, Palette, Place, label, text};
use crate::motion::{Horizon, Resources, Settings, Simulation};

/// The subject of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// The exact motion from two angles, as near as a method computes it.
    Motion,
    /// The linear motion from two angles. It leaves the exact motion, on purpose.
    LinearMotion,
    /// A figure without starting angles.
    Figure,
}

/// A figure that moves. It starts from settings, advances tick by tick, and is drawn when there is
/// time.
pub trait Scene: Sized {
    /// The subject of the scene.
    const SHOWS: Shows;
    /// The fading of the ink after each tick. By default it is that of a trace, which stays
    /// visible.
    const FADING: Fading = Fading::TRACE;
    /// The colours of the scene.
    const PALETTE: Palette = Palette::Trail;

    /// Creates the scene at its start. Returns also the height of the display for the plan, pixels;
    /// `None` if there is nothing to plan.
    ///
    /// On a display of this height, two rods as long as in the scene extend from the middle to the
    /// edge. If the scene shows angles as curves, it is the height of such a picture of the same
    /// accuracy.
    ///
    /// # Errors
    ///
    /// Returns the kernel's error if the settings describe no pendulum, or one that the scene
    /// cannot show, or if the requested method cannot compute the motion. A motion that is only too
    /// fast is no error.
    fn new(settings: &Settings, resources: &Resources) -> Result<(Self, Option<f32>), Error>;

    /// Advances to `ticks` ticks after the start, 1 more than at the last call, and adds the
    /// lasting part of the picture to the ink. The result is the same if earlier ticks were not
    /// drawn.
    fn tick(&mut self, ticks: u64, ink: &mut Canvas);

    /// Draws the rest of the picture in the clear foreground. `report` is the current report, so
    /// that its numbers need not be computed again.
    fn draw(&self, report: &Report, canvas: &mut Canvas);

    /// Returns the numbers of the scene, `ticks` ticks after the start. The player sets the
    /// horizon.
    fn report(&self, ticks: u64) -> Report {
        Report::at(ticks)
    }

    /// Returns the cost of a tick, cycles by these prices, of the motions that share the budget of a
    /// frame; 0 if nothing is planned.
    fn cost(&self, _: &Costs) -> f32 {
        0.0
    }

    /// Returns the cost of another motion or picture, without a budget, in the last tick.
    fn other_cost(&self, _: &Costs) -> f32 {
        0.0
    }

    /// Returns the motion whose method and step count the plan may change.
    fn planned(&mut self) -> Option<&mut Simulation> {
        None
    }

    /// Returns true if no method resolves the motion at a cost that a frame can pay. Then the scene
    /// must not advance.
    fn is_too_fast(&self) -> bool {
        false
    }
}

/// The smallest relative energy error that `f64` can resolve: the energy is a sum of some 20
/// rounded numbers.
pub const LEAST_ENERGY_ERROR: f32 = 4e-15;

/// The numbers of a scene at one tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Report {
    /// The number of ticks of simulated time since the start of the scene.
    pub step: u64,
    /// The simulated time since the start, s.
    pub time: f64,
    /// The state of the first pendulum shown, in SI units; zeros if no pendulum moves. By RK4 in
    /// `f32` it may be up to half a step ahead of `time`, or behind it.
    pub state: State<f32>,
    /// The relative energy error (E - E0)/(E0 - Emin) of that pendulum, where Emin is the energy of
    /// hanging at rest. An error smaller than [`LEAST_ENERGY_ERROR`] is rounding of the energy
    /// itself.
    pub energy_error: f32,
    /// The accuracy horizon of the scene.
    pub horizon: Horizon,
    /// The method and its step count per tick; `None` for a figure, for two fixed arithmetics, and
    /// for a scene that is too fast.
    pub stepping: Option<Stepping>,
}

impl Report {
    /// Returns the report of a figure without a moving pendulum.
    fn at(ticks: u64) -> Self {
        Self {
            step: ticks,
            time: time(ticks),
            ..Self::default()
        }
    }

    /// Returns the report of a scene whose first pendulum is `simulation`.
    pub fn of(simulation: &Simulation) -> Self {
        let motion = &simulation.motion;
        Self {
            state: motion.rounded_state(),
            energy_error: simulation.energy.error(motion),
            stepping: Some(motion.stepping()),
            ..Self::at(simulation.frame())
        }
    }
}

/// Returns the simulated time after `ticks` ticks, s.
fn time(ticks: u64) -> f64 {
    ticks as f64 / f64::from(TICK_RATE)
}

/// Writes the time and the horizon. The time is highlighted when the horizon is known and past.
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

/// Defines the scenes. Each row contains the number on the wire, the name of the scene, its type,
/// and its initial settings.
macro_rules! catalogue {
    ($($number:literal $row:ident = $name:literal, $scene:ty, $first:expr;)*) => {
        choice! {
            /// The name of a scene of the catalogue:
            ///
            /// - `page`: a pendulum with the trail of bob 2;
            /// - `small-0.2`, `small-1`, `small-5`: both angles of small oscillations over time, by
            ///   the linear model, initially with this mass ratio m2/m1;
            /// - `frequencies`: both frequencies of small oscillations over the mass ratio;
            /// - `beats-3-2`, `beats-2-1`, `beats-5-2`, `beats-3-1`: the parts of angle 2 in the
            ///   fast and in the slow mode, plotted against each other, by the linear and by the
            ///   exact motion, initially with this ratio of the two frequencies;
            /// - `figure-7`: a chaotic motion by the correct equations and by the page's misprints;
            /// - `butterfly`: two pendulums that start a millionth of a radian apart;
            /// - `upright`: a start with both rods straight up, in plain and in compensated `f32`;
            /// - `flips`: the map of all starts from rest, with the time until a rod turns over.
            SceneName { $($row = $name;)* }
        }

        // A scene goes over the wire as the place of its row.
        $(const _: () = assert!(SceneName::$row as u32 == $number);)*

        impl SceneName {
            /// Returns the initial settings of the scene.
            pub fn first_settings(self) -> Settings {
                match self { $(Self::$row => $first,)* }
            }

            /// Returns the subject of the scene.
            pub const fn shows(self) -> Shows {
                match self { $(Self::$row => <$scene>::SHOWS,)* }
            }

            /// Returns the colours of the scene.
            pub const fn palette(self) -> Palette {
                match self { $(Self::$row => <$scene>::PALETTE,)* }
            }
        }

        #[expect(
            clippy::large_enum_variant,
            reason = "without a heap there is nowhere else to keep it"
        )]
        /// A scene of the catalogue, with its state. The variant is its name.
        #[derive(Clone, Debug)]
        pub enum AnyScene { $($row($scene),)* }

        impl AnyScene {
            /// Starts the scene `name` in place of this one, as [`Scene::new`]. The ink is not
            /// cleared. After an error this scene continues.
            pub fn start(
                &mut self,
                name: SceneName,
                settings: &Settings,
                resources: &Resources,
            ) -> Result<Option<f32>, Error> {
                match name {
                    $(SceneName::$row => self.become_one(settings, resources, Self::$row),)*
                }
            }

            /// Advances the scene, as [`Scene::tick`], and fades the ink.
            pub fn tick(&mut self, ticks: u64, canvas: &mut Canvas) {
                let ink = canvas.on_ink();
                let fading = match self {
                    $(Self::$row(scene) => {
                        scene.tick(ticks, ink);
                        <$scene>::FADING
                    })*
                };
                ink.fade(fading);
            }

            /// Draws the foreground of the frame, as [`Scene::draw`].
            pub fn draw(&self, report: &Report, canvas: &mut Canvas) {
                let canvas = canvas.on_clear_foreground();
                match self { $(Self::$row(scene) => scene.draw(report, canvas),)* }
            }

            /// Returns the cost of the motions of a tick ([`Scene::cost`]).
            pub fn cost(&self, costs: &Costs) -> f32 {
                match self { $(Self::$row(scene) => scene.cost(costs),)* }
            }

            /// Returns the cost of another motion ([`Scene::other_cost`]).
            pub fn other_cost(&self, costs: &Costs) -> f32 {
                match self { $(Self::$row(scene) => scene.other_cost(costs),)* }
            }

            /// Returns the motion that is planned, as [`Scene::planned`].
            pub fn planned(&mut self) -> Option<&mut Simulation> {
                match self { $(Self::$row(scene) => scene.planned(),)* }
            }

            /// Returns true if the scene must not advance ([`Scene::is_too_fast`]).
            pub fn is_too_fast(&self) -> bool {
                match self { $(Self::$row(scene) => scene.is_too_fast(),)* }
            }

            /// Returns the numbers of the scene ([`Scene::report`]).
            pub fn report(&self, ticks: u64) -> Report {
                match self { $(Self::$row(scene) => scene.report(ticks),)* }
            }
        }
    };
}

catalogue! {
    0  Page = "page", pendulums::Page, Settings::default();
    1  SmallLight = "small-0.2", small::Small, small::example(0.2);
    2  SmallEqual = "small-1", small::Small, small::example(1.0);
    3  SmallHeavy = "small-5", small::Small, small::example(5.0);
    4  Frequencies = "frequencies", frequencies::Frequencies, Settings::default();
    5  Beats3To2 = "beats-3-2", beats::Beats, beats::closing(25.0 / 144.0);
    6  Beats2To1 = "beats-2-1", beats::Beats, beats::closing(9.0 / 16.0);
    7  Beats5To2 = "beats-5-2", beats::Beats, beats::closing(441.0 / 400.0);
    8  Beats3To1 = "beats-3-1", beats::Beats, beats::closing(16.0 / 9.0);
    9  Figure7 = "figure-7", pendulums::Figure7, pendulums::figure_7();
    10 Butterfly = "butterfly", butterfly::Butterfly, Settings::default();
    11 Upright = "upright", pendulums::Upright, Settings::equal_rods(1.0, GREATEST_ANGLE);
    12 Flips = "flips", flips::Flips, Settings::default();
}

impl AnyScene {
    /// Returns an empty figure, which takes the place of a scene until one starts.
    pub fn empty() -> Self {
        Self::Frequencies(frequencies::Frequencies::default())
    }

    /// Starts a scene of type `S`, wrapped by `one`, in place of this one.
    // With all scenes inlined, `play_by` has a stack frame of 7,604 bytes.
    #[inline(never)]
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
    /// Returns true if the scene starts from two angles.
    pub fn has_angles(self) -> bool {
        self.shows() != Shows::Figure
    }

    /// Returns true if the scene shows the linear motion.
    pub fn is_linear(self) -> bool {
        self.shows() == Shows::LinearMotion
    }

    /// Returns the place of the first pendulum on a panel; `None` if the scene shows none.
    pub fn place(self, format: Format) -> Option<Place> {
        match self {
            Self::Page => Some(Place::whole(format)),
            Self::Butterfly => Some(butterfly::Layout::of(format).place),
            Self::Figure7 | Self::Upright => Some(Place::halves(format)[0]),
            Self::SmallLight
            | Self::SmallEqual
            | Self::SmallHeavy
            | Self::Frequencies
            | Self::Beats3To2
            | Self::Beats2To1
            | Self::Beats5To2
            | Self::Beats3To1
            | Self::Flips => None,
        }
    }

    /// Returns the next scene of the catalogue; after the last the first.
    pub fn next(self) -> Self {
        self.turned(1)
    }

    /// Returns the previous scene of the catalogue; before the first the last.
    pub fn previous(self) -> Self {
        self.turned(Self::ALL.len() - 1)
    }

    /// Returns the scene `by` rows further in the catalogue, which is cyclic.
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
