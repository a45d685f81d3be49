//! What a motion starts from: the pendulum, and where it is let go.

use double_pendulum::plan::{PlannedRun, Problem, Stepping};
use double_pendulum::{Error, Motion, Parameters, Pendulum, State};

use crate::config::{
    ANGLE_STEP, FIRST_ANGLE, FIRST_MASS_RATIO, GRAVITY, GREATEST_ANGLE, HALF_PIXEL, MASS_RATIOS,
    PLANNED, ROD, TICK_RATE,
};
use crate::graphics::HEIGHT;

/// A double pendulum and its start.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Settings {
    pub parameters: Parameters<f32>,
    /// Start angles of rod 1 and rod 2, degrees from the downward vertical.
    pub degrees: [f32; 2],
    /// Angular velocities of rod 1 and rod 2 at the start, rad/s.
    pub velocities: [f32; 2],
}

impl Default for Settings {
    fn default() -> Self {
        Self::equal_rods(FIRST_MASS_RATIO, FIRST_ANGLE)
    }
}

impl Settings {
    /// The page's pendulum: equal rods, let go from rest with both rods at one angle.
    pub fn equal_rods(mass_ratio: f32, degrees: f32) -> Self {
        let parameters = Parameters::equal_rods(mass_ratio, ROD, GRAVITY as f32);
        Self {
            parameters,
            degrees: [degrees; 2],
            velocities: [0.0; 2],
        }
    }

    pub fn mass_ratio(&self) -> f32 {
        self.parameters.mass_ratio()
    }

    /// With bob 2 of another mass, so that the mass ratio is `mass_ratio`.
    pub fn with_mass_ratio(self, mass_ratio: f32) -> Self {
        Self {
            parameters: Parameters {
                m2: self.parameters.m1 * mass_ratio,
                ..self.parameters
            },
            ..self
        }
    }

    /// With the next larger mass ratio of [`MASS_RATIOS`]; the largest stays.
    pub fn heavier(self) -> Self {
        let next = MASS_RATIOS
            .iter()
            .copied()
            .find(|&ratio| ratio > self.mass_ratio());
        next.map_or(self, |ratio| self.with_mass_ratio(ratio))
    }

    /// With the next smaller mass ratio of [`MASS_RATIOS`]; the smallest stays.
    pub fn lighter(self) -> Self {
        let next = MASS_RATIOS
            .iter()
            .copied()
            .rev()
            .find(|&ratio| ratio < self.mass_ratio());
        next.map_or(self, |ratio| self.with_mass_ratio(ratio))
    }

    /// Both rods turned by one [`ANGLE_STEP`], counter-clockwise if `steps` is 1, clockwise if it is -1; each stops at
    /// straight up.
    pub fn turned(self, steps: i8) -> Self {
        let turn = |degrees: f32| {
            (degrees + f32::from(steps) * ANGLE_STEP).clamp(-GREATEST_ANGLE, GREATEST_ANGLE)
        };
        Self {
            degrees: self.degrees.map(turn),
            ..self
        }
    }

    /// Start angles of rod 1 and rod 2, rad: pi/180 times the degrees.
    pub fn angles(&self) -> [f32; 2] {
        self.degrees.map(f32::to_radians)
    }

    pub fn motion(&self) -> Motion<f32> {
        let ([a1, a2], [w1, w2]) = (self.angles(), self.velocities);
        Motion { a1, a2, w1, w2 }
    }

    /// The pendulum and where it starts; the kernel's error if they describe none, or no finite state.
    pub fn start(&self) -> Result<(Pendulum<f32>, State<f32>), Error> {
        let (pendulum, motion) = (Pendulum::new(&self.parameters)?, self.motion());
        motion.check()?;
        let state = pendulum.to_state(&motion);
        state.check()?;
        Ok((pendulum, state))
    }

    /// As it is planned on a display `height` pixels high.
    pub fn problem(&self, height: f32) -> Problem {
        let pendulum = self.parameters.cast();
        Problem {
            pendulum,
            start: self.motion().cast(),
            tolerance: half_pixel(&pendulum, height.into()),
            duration: PLANNED,
            rate: TICK_RATE as u16,
        }
    }

    /// The motion by this `stepping`, with rod 1 ahead by `apart` rad.
    pub fn run(&self, apart: f64, stepping: Stepping) -> Result<PlannedRun, Error> {
        let mut problem = self.problem(HEIGHT as f32);
        problem.start.a1 += apart;
        PlannedRun::new(&problem, stepping)
    }
}

/// [`HALF_PIXEL`] in metres on a display `height` pixels high: both rods together are half of it long.
pub fn half_pixel(&Parameters { l1, l2, .. }: &Parameters<f64>, height: f64) -> f64 {
    f64::from(HALF_PIXEL) * (l1 + l2) / (0.5 * height)
}
