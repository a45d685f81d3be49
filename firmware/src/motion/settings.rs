//! The settings of a motion: the pendulum and its start.

use double_pendulum::plan::{PlannedRun, Problem, Stepping};
use double_pendulum::{Error, Motion, Parameters, Pendulum, State};

use crate::config::{
    ANGLE_STEP, FIRST_ANGLE, FIRST_MASS_RATIO, GRAVITY, GREATEST_ANGLE, HALF_PIXEL, MASS_RATIOS,
    PLANNED, ROD, TICK_RATE,
};
use crate::graphics::HEIGHT;

/// A double pendulum, its initial angles and its initial angular velocities.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Settings {
    pub parameters: Parameters<f32>,
    /// The start angles of rod 1 and rod 2, degrees from the downward vertical.
    pub degrees: [f32; 2],
    /// The angular velocities of rod 1 and rod 2 at the start, rad/s.
    pub velocities: [f32; 2],
}

impl Default for Settings {
    fn default() -> Self {
        Self::equal_rods(FIRST_MASS_RATIO, FIRST_ANGLE)
    }
}

impl Settings {
    /// Returns the page's pendulum: equal rods, released from rest with both rods at one angle.
    pub fn equal_rods(mass_ratio: f32, degrees: f32) -> Self {
        let parameters = Parameters::equal_rods(mass_ratio, ROD, GRAVITY as f32);
        Self {
            parameters,
            degrees: [degrees; 2],
            velocities: [0.0; 2],
        }
    }

    /// Returns the mass ratio m2/m1.
    pub fn mass_ratio(&self) -> f32 {
        self.parameters.mass_ratio()
    }

    /// Returns the settings with the mass of bob 2 changed, so that the mass ratio is `mass_ratio`.
    pub fn with_mass_ratio(self, mass_ratio: f32) -> Self {
        Self {
            parameters: Parameters {
                m2: self.parameters.m1 * mass_ratio,
                ..self.parameters
            },
            ..self
        }
    }

    /// Returns the settings with the next larger mass ratio of [`MASS_RATIOS`]. The largest one
    /// stays.
    pub fn heavier(self) -> Self {
        let next = MASS_RATIOS
            .iter()
            .copied()
            .find(|&ratio| ratio > self.mass_ratio());
        next.map_or(self, |ratio| self.with_mass_ratio(ratio))
    }

    /// Returns the settings with the next smaller mass ratio of [`MASS_RATIOS`]. The smallest one
    /// stays.
    pub fn lighter(self) -> Self {
        let next = MASS_RATIOS
            .iter()
            .copied()
            .rev()
            .find(|&ratio| ratio < self.mass_ratio());
        next.map_or(self, |ratio| self.with_mass_ratio(ratio))
    }

    /// Returns the settings with both rods turned by one [`ANGLE_STEP`], counter-clockwise if
    /// `steps` is 1, clockwise if it is -1. Each rod stops at straight up.
    pub fn turned(self, steps: i8) -> Self {
        let turn = |degrees: f32| {
            (degrees + f32::from(steps) * ANGLE_STEP).clamp(-GREATEST_ANGLE, GREATEST_ANGLE)
        };
        Self {
            degrees: self.degrees.map(turn),
            ..self
        }
    }

    /// Returns the start angles of rod 1 and rod 2, rad: pi/180 times the degrees.
    pub fn angles(&self) -> [f32; 2] {
        self.degrees.map(f32::to_radians)
    }

    /// Returns the angles and angular velocities at the start.
    pub fn motion(&self) -> Motion<f32> {
        let ([a1, a2], [w1, w2]) = (self.angles(), self.velocities);
        Motion { a1, a2, w1, w2 }
    }

    /// Returns the pendulum and its initial state, in SI units. Returns the kernel's error if the
    /// settings describe no pendulum, or no finite state.
    pub fn start(&self) -> Result<(Pendulum<f32>, State<f32>), Error> {
        let pendulum = Pendulum::new(&self.parameters)?;
        let motion = self.motion();
        motion.check()?;
        let state = pendulum.to_state(&motion);
        state.check()?;
        Ok((pendulum, state))
    }

    /// Returns the problem to plan for a display `height` pixels high.
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

    /// Returns the motion by this method and step count, with rod 1 ahead by `apart` rad.
    pub fn run(&self, apart: f64, stepping: Stepping) -> Result<PlannedRun, Error> {
        let mut problem = self.problem(HEIGHT as f32);
        problem.start.a1 += apart;
        PlannedRun::new(&problem, stepping)
    }
}

/// Returns [`HALF_PIXEL`] in metres on a display `height` pixels high. The length of both rods
/// together is half of that height.
pub fn half_pixel(&Parameters { l1, l2, .. }: &Parameters<f64>, height: f64) -> f64 {
    f64::from(HALF_PIXEL) * (l1 + l2) / (0.5 * height)
}
