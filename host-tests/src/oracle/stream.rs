//! What a board streams of the page's scene, by the kernel alone: nothing of the firmware but its rate.

use double_pendulum::Method;
use double_pendulum::plan::{PlannedRun, Way};
use double_pendulum::{Motion, Parameters};
use firmware::config::{GRAVITY, ROD, TICK_RATE};

/// Equal rods let go from rest, in 64 bits of fixed point, a step to a frame.
#[derive(Clone, Debug)]
pub struct Expected(PlannedRun);

impl Expected {
    /// From rest with both rods at `angle` (rad).
    pub fn new(mass_ratio: f32, angle: f32) -> Self {
        let parameters = Parameters::equal_rods(mass_ratio, ROD, GRAVITY as f32).cast();
        let start = Motion::at_rest(angle.into(), angle.into());
        let way = Way { method: Method::Extrapolation10Fixed64, steps: 1 };
        Self(PlannedRun::new(&parameters, &start, TICK_RATE as u16, way).expect("the board simulates it"))
    }

    /// Makes a frame's step.
    pub fn tick(&mut self) {
        self.0.advance(1).expect("a finite motion");
    }

    /// a1, a2, p1, p2 as they are streamed.
    pub fn state(&self) -> [f32; 4] {
        self.0.rounded_state().into()
    }
}
