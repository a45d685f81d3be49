//! The settings of a motion: the pendulum and its start.

use double_pendulum::plan::{PlannedRun, Problem, Stepping};
use double_pendulum::{Error, Motion, Parameters, Pendulum, State, radians};

use crate::config::{
    ANGLE_STEP, FIRST_ANGLE, FIRST_MASS_RATIO, GRAVITY, GREATEST_ANGLE, HALF_PIXEL, MASS_RATIOS,
    PLANNED, ROD, TICK_RATE,
};
use crate::graphics::Format;

/// A double pendulum, its initial angles and its initial angular velocities.
///
/// Any numbers can be stored; [`start`](Self::start) checks them. The default is the settings at
/// power-on.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Settings {
    /// Masses (kg), lengths (m) and gravity (m/s^2).
    pub parameters: Parameters<f64>,
    /// The start angles of rod 1 and rod 2, degrees from the downward vertical, positive
    /// counter-clockwise.
    pub degrees: [f64; 2],
    /// The angular velocities of rod 1 and rod 2 at the start, rad/s.
    pub velocities: [f64; 2],
}

impl Default for Settings {
    fn default() -> Self {
        Self::equal_rods(FIRST_MASS_RATIO, FIRST_ANGLE)
    }
}

impl Settings {
    /// Returns a pendulum with rods of [`ROD`], a first bob of 1 kg and this mass ratio, released
    /// from rest at this angle.
    pub fn equal_rods(mass_ratio: f64, degrees: f64) -> Self {
        let parameters = Parameters::equal_rods(mass_ratio, ROD, GRAVITY);
        Self {
            parameters,
            degrees: [degrees; 2],
            velocities: [0.0; 2],
        }
    }

    /// Returns the mass ratio m2/m1.
    pub fn mass_ratio(&self) -> f32 {
        self.parameters.mass_ratio() as f32
    }

    /// Returns the settings with this mass ratio, by another m2.
    pub fn with_mass_ratio(self, mass_ratio: f64) -> Self {
        Self {
            parameters: Parameters {
                m2: self.parameters.m1 * mass_ratio,
                ..self.parameters
            },
            ..self
        }
    }

    /// Returns the settings with the next larger mass ratio of [`MASS_RATIOS`], or unchanged if
    /// there is none. Ratios are compared after rounding, so that a second call never stays at the
    /// same value.
    pub fn heavier(self) -> Self {
        let next = MASS_RATIOS
            .iter()
            .copied()
            .map(|ratio| self.with_mass_ratio(ratio))
            .find(|next| next.parameters.mass_ratio() > self.parameters.mass_ratio());
        next.unwrap_or(self)
    }

    /// Returns the settings with the next smaller mass ratio, as [`heavier`](Self::heavier).
    pub fn lighter(self) -> Self {
        let next = MASS_RATIOS
            .iter()
            .copied()
            .rev()
            .map(|ratio| self.with_mass_ratio(ratio))
            .find(|next| next.parameters.mass_ratio() < self.parameters.mass_ratio());
        next.unwrap_or(self)
    }

    /// Returns the settings with both rods turned by `steps` times [`ANGLE_STEP`],
    /// counter-clockwise if `steps` is positive. Each rod stops at straight up.
    pub fn turned(self, steps: i8) -> Self {
        let turn = |degrees: f64| {
            (degrees + f64::from(steps) * ANGLE_STEP).clamp(-GREATEST_ANGLE, GREATEST_ANGLE)
        };
        Self {
            degrees: self.degrees.map(turn),
            ..self
        }
    }

    /// Returns the start angles, rad.
    pub fn angles(&self) -> [f64; 2] {
        self.degrees.map(radians)
    }

    /// Returns the motion at the start, in rad and rad/s.
    pub fn motion(&self) -> Motion<f64> {
        let ([a1, a2], [w1, w2]) = (self.angles(), self.velocities);
        Motion { a1, a2, w1, w2 }
    }

    /// Returns the pendulum and its initial state, both checked.
    pub fn start(&self) -> Result<(Pendulum<f64>, State<f64>), Error> {
        let pendulum = Pendulum::new(&self.parameters)?;
        let motion = self.motion();
        motion.check()?;
        let state = pendulum.to_state(&motion);
        state.check()?;
        // A frame reports it in `f32`.
        state.cast::<f32>().check()?;
        Ok((pendulum, state))
    }

    /// Returns true if the pendulum never moves from its start.
    pub fn rests(&self) -> bool {
        self.start()
            .is_ok_and(|(pendulum, start)| pendulum.rests(&start))
    }

    /// Returns the problem to plan for a display `height` pixels high, in whose half height both
    /// rods fit.
    pub fn problem(&self, height: f32) -> Problem {
        Problem {
            pendulum: self.parameters,
            start: self.motion(),
            tolerance: half_pixel(&self.parameters, height.into()),
            duration: PLANNED,
            rate: TICK_RATE as u16,
        }
    }

    /// Returns the motion at its start, by this method and step count per tick. Angle 1 starts
    /// `apart` rad larger than in the settings.
    pub fn run(&self, apart: f64, stepping: Stepping) -> Result<PlannedRun, Error> {
        let mut problem = self.problem(Format::OLED.height.into());
        problem.start.a1 += apart;
        PlannedRun::new(&problem, stepping)
    }
}

/// Returns [`HALF_PIXEL`] in metres on a display `height` pixels high, in whose half height both
/// rods fit.
pub fn half_pixel(&Parameters { l1, l2, .. }: &Parameters<f64>, height: f64) -> f64 {
    f64::from(HALF_PIXEL) * (l1 + l2) / (0.5 * height)
}
