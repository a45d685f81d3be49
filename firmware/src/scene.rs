//! What every scene is.

use double_pendulum::{Error, State};

use crate::canvas::Canvas;
use crate::ink::Ink;
use crate::settings::Settings;
use crate::simulation::Simulation;

/// Something to watch: it starts from settings, moves tick by tick and is drawn when there is time for it.
pub trait Scene: Sized {
    /// At the start; the kernel's error if the settings describe no pendulum, or none that this scene can show.
    fn new(settings: &Settings) -> Result<Self, Error>;

    /// Advances by one tick and adds to the ink what shall stay. The picture after n ticks does not depend on which of
    /// them were drawn.
    fn tick(&mut self, ink: &mut Ink);

    /// Draws over the ink.
    fn draw(&self, canvas: &mut Canvas);

    /// What is to be told about it in numbers.
    fn report(&self) -> Report;
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
    /// Until when the picture is right to half a pixel, s after the start; infinity as long as that is not known.
    pub trusted_until: f32,
}

impl Report {
    /// Of a scene whose first pendulum is `simulation`.
    pub fn of(simulation: &Simulation, trusted_until: f32) -> Self {
        let state = simulation.state();
        Self {
            step: simulation.step(),
            time: simulation.time(),
            state,
            energy_error: simulation.energy().error(&state),
            trusted_until,
        }
    }
}
