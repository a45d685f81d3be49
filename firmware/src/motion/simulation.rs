//! The motion itself, apart from any frame of it: the state after n steps, and what its energy has become.

use double_pendulum::{Error, Pendulum, State};

use crate::config::{DT, STEPS_PER_SECOND, STEPS_PER_TICK};
use crate::motion::direction_stepper::{Directions, UnwrappedDirectionStepper};
use crate::motion::settings::Settings;

/// A pendulum in motion since its last restart.
#[derive(Clone, Debug)]
pub struct Simulation {
    energy: Energy,
    swing: UnwrappedDirectionStepper,
    step: u64,
    /// The precise state now, once it was asked for: it takes as long as a step and a half.
    precise: Option<State<f64>>,
}

impl Simulation {
    /// At the start; the kernel's error if the settings describe no pendulum, or one too quick for [`DT`].
    pub fn new(settings: &Settings) -> Result<Self, Error> {
        let pendulum = settings.pendulum()?;
        pendulum.check_step(DT)?;
        let start = settings.start(&pendulum)?;
        Ok(Self {
            energy: Energy::new(pendulum, &start),
            swing: UnwrappedDirectionStepper::new(&settings.parameters, &start, DT)?,
            step: 0,
            precise: None,
        })
    }

    /// Advances by one tick: [`STEPS_PER_TICK`] steps of [`DT`] seconds.
    pub fn tick(&mut self) {
        self.precise = None;
        self.swing.advance(STEPS_PER_TICK);
        self.step = self.step.wrapping_add(STEPS_PER_TICK.into());
    }

    /// Where the rods point: all that most frames need.
    pub fn directions(&self) -> Directions {
        self.swing.directions()
    }

    /// The canonical state now, rounded to `f32`, its angles unwrapped.
    pub fn state(&self) -> State<f32> {
        let state = self.precise.unwrap_or_else(|| self.swing.stepper().state());
        self.swing.unwrap(state).cast()
    }

    /// The canonical state to the last digit carried, each angle within half a turn of hanging.
    pub fn precise_state(&mut self) -> State<f64> {
        *self.precise.get_or_insert_with(|| self.swing.stepper().state())
    }

    /// Steps since the start. They never wrap: that would take 2.4 thousand million years.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Simulated time since the start, s.
    pub fn time(&self) -> f64 {
        self.step as f64 / f64::from(STEPS_PER_SECOND)
    }

    /// What its energy is measured by.
    pub fn energy(&self) -> &Energy {
        &self.energy
    }
}

/// The energy a motion started with, to hold what it has become against.
#[derive(Clone, Debug)]
pub struct Energy {
    pendulum: Pendulum<f32>,
    /// J.
    start: f32,
}

impl Energy {
    /// Of a motion of `pendulum` that starts at `start`.
    pub fn new(pendulum: Pendulum<f32>, start: &State<f32>) -> Self {
        Self { pendulum, start: pendulum.energy(start) }
    }

    /// The equations of motion it belongs to.
    pub fn pendulum(&self) -> &Pendulum<f32> {
        &self.pendulum
    }

    /// (E - E0)/(E0 - Emin), with E0 the energy at the start and Emin that of hanging at rest; 0 if the start is
    /// hanging at rest, which it never leaves.
    pub fn error(&self, state: &State<f32>) -> f32 {
        let scale = self.start - self.pendulum.least_energy();
        if scale > 0.0 { (self.pendulum.energy(state) - self.start) / scale } else { 0.0 }
    }
}
