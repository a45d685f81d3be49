//! What every scene is.

use double_pendulum::plan::Method;
use double_pendulum::{Error, State};

use crate::config::STEPS_PER_TICK;
use crate::graphics::canvas::Canvas;
use crate::graphics::fade_layer::{FadeLayer, Fading};
use crate::motion::planner::Shown;
use crate::motion::settings::Settings;
use crate::motion::simulation::Simulation;

/// Something to watch: it starts from settings, moves tick by tick and is drawn when there is time for it.
pub trait Scene: Sized {
    /// How its ink pales.
    const FADING: Fading = Fading::TRACE;

    /// At the start; the kernel's error if the settings describe no pendulum, or none that this scene can show.
    fn new(settings: &Settings) -> Result<Self, Error>;

    /// Advances by one tick and adds to the ink what shall stay. The frame after n ticks does not depend on which of
    /// them were drawn.
    fn tick(&mut self, ink: &mut FadeLayer);

    /// Draws over the ink; `report` is what it has just been told in numbers, which need not be found twice.
    fn draw(&self, report: &Report, canvas: &mut Canvas);

    /// What is to be told about it in numbers.
    fn report(&self) -> Report;

    /// How it shows the motion of its settings; `None` if nothing of it moves.
    fn shown(&self) -> Option<Shown>;
}

/// A scene in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// Integration steps since the start; where nothing is integrated, ticks.
    pub step: u64,
    /// Simulated time since the start, s.
    pub time: f64,
    /// The canonical state of the first pendulum shown; zeros where none moves.
    pub state: State<f32>,
    /// (E - E0)/(E0 - Emin) of that pendulum: its energy error relative to the energy at the start above hanging at rest.
    pub energy_error: f32,
    /// Until when the frame is right to [half a pixel](crate::config::HALF_PIXEL) about the exact motion, s after the start;
    /// infinity as long as it is.
    pub horizon: f32,
}

impl Report {
    /// Of a scene whose first pendulum is `simulation`.
    pub fn of(simulation: &Simulation, horizon: f32) -> Self {
        let state = simulation.state();
        Self {
            step: simulation.step(),
            time: simulation.time(),
            state,
            energy_error: simulation.energy().error(&state),
            horizon,
        }
    }
}

impl Shown {
    /// As a pendulum whose rods together are `reach` pixels long, by a
    /// [`DirectionStepper`](crate::motion::direction_stepper::DirectionStepper).
    pub fn pendulum(reach: f32) -> Option<Self> {
        Some(Self { method: Method::Direction, steps: STEPS_PER_TICK, height: 2.0 * reach })
    }

    /// As curves of the angles, `scale` pixels to a radian; the rods of a display that shows as much are as long each.
    pub fn curves(method: Method, scale: f32) -> Option<Self> {
        (scale > 0.0).then_some(Self { method, steps: STEPS_PER_TICK, height: 4.0 * scale })
    }
}
