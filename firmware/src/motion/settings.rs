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
/// Any numbers can be stored, and the methods that change them check nothing.
/// [`start`](Self::start) checks them. The default is [`equal_rods`](Self::equal_rods) with a mass
/// ratio of 1 and 120 degrees, the settings at power-on.
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
    /// Returns a pendulum with equal rods: rods of 1 m ([`ROD`]), a first bob of 1 kg, a gravity of
    /// 9.81 m/s^2 ([`GRAVITY`]), and the mass ratio m2/m1. Both rods are released from rest at the
    /// angle `degrees`.
    pub fn equal_rods(mass_ratio: f64, degrees: f64) -> Self {
        let parameters = Parameters::equal_rods(mass_ratio, ROD, GRAVITY);
        Self {
            parameters,
            degrees: [degrees; 2],
            velocities: [0.0; 2],
        }
    }

    /// Returns the mass ratio m2/m1. An m1 of 0 gives infinity or NaN.
    pub fn mass_ratio(&self) -> f32 {
        self.parameters.mass_ratio() as f32
    }

    /// Returns the settings with the mass of bob 2 changed, so that the mass ratio m2/m1 is
    /// `mass_ratio`, which is not checked. An m1 of 0 gives an m2 of 0, and no such ratio.
    pub fn with_mass_ratio(self, mass_ratio: f64) -> Self {
        Self {
            parameters: Parameters {
                m2: self.parameters.m1 * mass_ratio,
                ..self.parameters
            },
            ..self
        }
    }

    /// Returns the settings with the next larger mass ratio of [`MASS_RATIOS`], 0.01 to 100, by
    /// another m2. From the largest one on, 100, and for NaN, they are unchanged. Rounding counts:
    /// a ratio just below a value of the table becomes that value. After a value that a call has
    /// set, the next call sets the next one.
    pub fn heavier(self) -> Self {
        let next = MASS_RATIOS
            .iter()
            .copied()
            .map(|ratio| self.with_mass_ratio(ratio))
            .find(|next| next.parameters.mass_ratio() > self.parameters.mass_ratio());
        next.unwrap_or(self)
    }

    /// Returns the settings with the next smaller mass ratio of [`MASS_RATIOS`], 0.01 to 100, by
    /// another m2. From the smallest one down, 0.01, for NaN, and for an m1 of 0, they are
    /// unchanged. Rounding counts as in [`heavier`](Self::heavier).
    pub fn lighter(self) -> Self {
        let next = MASS_RATIOS
            .iter()
            .copied()
            .rev()
            .map(|ratio| self.with_mass_ratio(ratio))
            .find(|next| next.parameters.mass_ratio() < self.parameters.mass_ratio());
        next.unwrap_or(self)
    }

    /// Returns the settings with the start angles of both rods turned by `steps` times
    /// [`ANGLE_STEP`], 1 degree, counter-clockwise if `steps` is positive. Each rod stops at
    /// straight up, 180 or -180 degrees; an angle that is already beyond is moved there, also by 0
    /// steps. An angle that is NaN stays NaN.
    pub fn turned(self, steps: i8) -> Self {
        let turn = |degrees: f64| {
            (degrees + f64::from(steps) * ANGLE_STEP).clamp(-GREATEST_ANGLE, GREATEST_ANGLE)
        };
        Self {
            degrees: self.degrees.map(turn),
            ..self
        }
    }

    /// Returns the start angles of rod 1 and rod 2, rad: pi/180 times the degrees.
    pub fn angles(&self) -> [f64; 2] {
        self.degrees.map(radians)
    }

    /// Returns the angles, rad, and the angular velocities, rad/s, at the start.
    pub fn motion(&self) -> Motion<f64> {
        let ([a1, a2], [w1, w2]) = (self.angles(), self.velocities);
        Motion { a1, a2, w1, w2 }
    }

    /// Returns the pendulum and its initial canonical state, in SI units: the angles in rad, not in
    /// degrees, and the momenta in kg m^2/s.
    ///
    /// # Errors
    ///
    /// Refuses masses, lengths and gravity that [`Pendulum::new`] refuses, and angles, velocities
    /// or resulting momenta that are not finite. Angles beyond straight up are accepted.
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
    /// rods fit: a tolerance of half a pixel, in m, [`PLANNED`] seconds, 30, and [`TICK_RATE`]
    /// frames per second, 60. Angles are in rad there. Nothing is checked.
    pub fn problem(&self, height: f32) -> Problem {
        Problem {
            pendulum: self.parameters,
            start: self.motion(),
            tolerance: half_pixel(&self.parameters, height.into()),
            duration: PLANNED,
            rate: TICK_RATE as u16,
        }
    }

    /// Returns the motion at its start, by this method and step count per frame of 1/60 s. A count
    /// of 0 counts as 1, and the closed form always has 1. Angle 1 starts `apart` rad larger than
    /// in the settings; the velocities are those of the settings.
    ///
    /// # Errors
    ///
    /// Refuses settings that describe no pendulum or no finite start, numbers out of the range of
    /// the method, a step that the method cannot make, for the closed form a gravity of 0, and a
    /// method that is not in
    /// [`Method::DRAWN`](double_pendulum::Method::DRAWN). Most methods accept a step that is
    /// unstable ([`PlannedRun::new`]), unlike [`Simulation::new`](super::Simulation::new).
    pub fn run(&self, apart: f64, stepping: Stepping) -> Result<PlannedRun, Error> {
        let mut problem = self.problem(Format::OLED.height.into());
        problem.start.a1 += apart;
        PlannedRun::new(&problem, stepping)
    }
}

/// Returns [`HALF_PIXEL`] in metres on a display `height` pixels high, (l1 + l2)/`height`. The
/// length of both rods together is half of that height. Nothing is checked; a height of 0 gives
/// infinity or NaN.
pub fn half_pixel(&Parameters { l1, l2, .. }: &Parameters<f64>, height: f64) -> f64 {
    f64::from(HALF_PIXEL) * (l1 + l2) / (0.5 * height)
}
