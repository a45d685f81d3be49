//! A motion as frames need it: the directions of both rods, in the kernel's direction form.

use double_pendulum::form::{Compensated, Direction, DirectionForm, DirectionState, Form};
use double_pendulum::{Error, Parameters, State};

/// The directions of both rods, (sin, cos) each.
pub type Directions = [Direction<f32>; 2];

/// A pendulum in motion, in `f32` whose additions lose nothing.
#[derive(Clone, Copy, Debug)]
pub struct DirectionStepper {
    form: DirectionForm<f32>,
    carried: DirectionState<f32, Compensated<f32>>,
}

impl DirectionStepper {
    /// At `start`, with steps of `dt` seconds; the kernel's error if it takes no such pendulum, start or step.
    pub fn new(parameters: &Parameters<f32>, start: &State<f32>, dt: f32) -> Result<Self, Error> {
        let form = DirectionForm::new(parameters, dt)?;
        Ok(Self { form, carried: form.start(start)? })
    }

    /// Makes `steps` steps.
    pub fn advance(&mut self, steps: u32) {
        self.form.advance(&mut self.carried, steps);
    }

    /// Where the rods point.
    pub fn directions(&self) -> Directions {
        self.form.directions(&self.carried)
    }

    /// The canonical state to the last digit carried, each angle within half a turn of hanging. Two arc tangents in
    /// `f64`: once a frame, not once a step.
    pub fn state(&self) -> State<f64> {
        self.form.state(&self.carried)
    }
}
