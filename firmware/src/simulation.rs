//! The motion itself, apart from any picture of it: the state after n steps, and what its energy has become.

use double_pendulum::{Error, Pendulum, State};

use crate::config::{STEP, STEP_RATE, STEPS_PER_TICK};
use crate::settings::Settings;

/// A pendulum in motion since its last restart.
#[derive(Clone, Debug)]
pub struct Simulation {
    pendulum: Pendulum<f32>,
    state: State<f32>,
    step: u32,
    /// Energy at the start, J.
    start_energy: f32,
}

impl Simulation {
    /// At the start; the kernel's error if the settings describe no pendulum, or one too quick for [`STEP`].
    pub fn new(settings: &Settings) -> Result<Self, Error> {
        let pendulum = settings.pendulum()?;
        pendulum.check_step(STEP)?;
        let state = settings.start(&pendulum)?;
        let start_energy = pendulum.energy(&state);
        Ok(Self { pendulum, state, step: 0, start_energy })
    }

    /// Advances by one tick: [`STEPS_PER_TICK`] steps of [`STEP`] seconds.
    pub fn tick(&mut self) {
        for _ in 0..STEPS_PER_TICK {
            self.state = self.pendulum.step(&self.state, STEP);
        }
        self.step = self.step.wrapping_add(STEPS_PER_TICK);
    }

    /// The equations of motion it follows.
    pub fn pendulum(&self) -> &Pendulum<f32> {
        &self.pendulum
    }

    /// The canonical state now.
    pub fn state(&self) -> State<f32> {
        self.state
    }

    /// Steps since the start; begins again at 0 after 2^32 of them, 207 days.
    pub fn step(&self) -> u32 {
        self.step
    }

    /// Simulated time since the start, s.
    pub fn time(&self) -> f64 {
        f64::from(self.step) / f64::from(STEP_RATE)
    }

    /// (E - E0)/(E0 - Emin), with E0 the energy at the start and Emin that of hanging at rest; 0 if the start is
    /// hanging at rest, which it never leaves.
    pub fn energy_error(&self) -> f32 {
        let scale = self.start_energy - self.pendulum.least_energy();
        if scale > 0.0 { (self.pendulum.energy(&self.state) - self.start_energy) / scale } else { 0.0 }
    }
}
