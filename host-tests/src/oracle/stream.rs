//! What a board streams of the page's scene, by the kernel alone: nothing of the firmware but its step.

use double_pendulum::form::{DirectionForm, UnwrappedStepper};
use double_pendulum::{Parameters, State};
use firmware::config::{DT, GRAVITY, ROD};

/// Equal rods let go from rest, in compensated `f32`.
#[derive(Clone, Debug)]
pub struct Expected(UnwrappedStepper<f32, DirectionForm<f32>>);

impl Expected {
    /// From rest with both rods at `angle` (rad).
    pub fn new(mass_ratio: f32, angle: f32) -> Self {
        let parameters = Parameters::equal_rods(mass_ratio, ROD, GRAVITY as f32);
        let start = State::at_rest(angle, angle);
        Self(UnwrappedStepper::new(&parameters, &start, DT).expect("the board simulates it"))
    }

    /// Makes `steps` steps.
    pub fn advance(&mut self, steps: u32) {
        self.0.advance(steps);
    }

    /// a1, a2, p1, p2 as they are streamed.
    pub fn state(&self) -> [f32; 4] {
        self.0.state().cast().into()
    }
}
