//! What is to be shown.

use crate::error::{Error, Parameter};
use crate::params::Parameters;
use crate::real::Real;
use crate::state::{Motion, State};

/// A bob drawn farther than this, pixels, from where it belongs is drawn wrongly.
pub const HALF_PIXEL: f32 = 0.5;

/// A pendulum, its start, and how it is to be shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Problem {
    /// Masses, lengths and gravity.
    pub pendulum: Parameters<f64>,
    /// Angles and angular velocities at the start.
    pub start: Motion<f64>,
    /// The display's height, pixels: both rods together are half of it long.
    pub height: f64,
    /// How long it is shown, s.
    pub duration: f64,
    /// Frames per second.
    pub rate: u16,
}

impl Problem {
    /// Refuses NaN and infinite values, and a height, duration or rate that is not positive.
    ///
    /// The pendulum is checked where it is used.
    pub fn check(&self) -> Result<(), Error> {
        self.start.check()?;
        let positive = [
            (Parameter::Height, self.height),
            (Parameter::Duration, self.duration),
            (Parameter::Rate, f64::from(self.rate)),
        ];
        for (parameter, value) in positive {
            if !value.is_finite() {
                return Err(Error::NotFinite { parameter, value });
            }
            if value <= 0.0 {
                return Err(Error::NotPositive { parameter, value });
            }
        }
        let limit = f64::from(u32::MAX) / f64::from(self.rate);
        if self.duration > limit {
            return Err(Error::TooLarge { parameter: Parameter::Duration, value: self.duration, limit });
        }
        Ok(())
    }

    /// Frames shown after the one at the start, at least one.
    pub fn frames(&self) -> u32 {
        let frames = libm::rint(self.duration * f64::from(self.rate)) as u32;
        if frames == 0 { 1 } else { frames }
    }

    /// The time of frame `frame`, s.
    pub fn time(&self, frame: u32) -> f64 {
        f64::from(frame) / f64::from(self.rate)
    }

    /// The lengths of the rods, pixels.
    pub(super) fn rods(&self) -> [f32; 2] {
        let Parameters { l1, l2, .. } = self.pendulum;
        [l1, l2].map(|l| (0.5 * self.height * l / (l1 + l2)) as f32)
    }

    /// The scene, which starts from `start`, in the arithmetic `R`, or a twin of it.
    pub(super) fn rounded<R: Real>(&self, start: &State<f64>, twin: Twin) -> (Parameters<R>, State<R>) {
        let &State { a1, a2, p1, p2 } = start;
        let Parameters { m1, m2, l1, l2, g } = self.pendulum;
        let off = |value: f64, by: f64| R::from_f64(value * (1.0 + by * R::EPSILON.to_f64()));
        let [first, second] = match twin {
            Twin::None => [0.0, 0.0],
            Twin::Alike => [0.5, 0.5],
            Twin::Opposite => [0.5, -0.5],
        };
        let parameters = Parameters {
            m1: R::from_f64(m1),
            m2: off(m2, first),
            l1: R::from_f64(l1),
            l2: off(l2, second),
            g: off(g, second),
        };
        let state = State { a1: off(a1, first), a2: off(a2, second), p1: off(p1, second), p2: off(p2, first) };
        (parameters, state)
    }
}

/// Which of a scene's numbers are half an ulp off before they are rounded, and which way.
#[derive(Clone, Copy, Debug)]
pub(super) enum Twin {
    /// None.
    None,
    /// All, the same way.
    Alike,
    /// All, half of them the other way.
    Opposite,
}
