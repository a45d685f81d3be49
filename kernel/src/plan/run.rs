//! A motion computed step by step, and how far two of its frames are apart.

use crate::error::Error;
use crate::form::{Direction, Form, Stepper};
use crate::params::Parameters;
use crate::real::Real;
use crate::state::State;

/// The directions of both rods as they would be drawn.
pub type Directions = [Direction<f32>; 2];

/// A motion in the form `F`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(bound(
        serialize = "R: serde::Serialize, Stepper<R, F>: serde::Serialize",
        deserialize = "R: serde::Deserialize<'de>, Stepper<R, F>: serde::Deserialize<'de>"
    ))
)]
pub(super) struct Run<R: Real, F: Form<R>> {
    parameters: Parameters<R>,
    start: State<R>,
    /// The step, s.
    dt: f64,
    motion: Option<Stepper<R, F>>,
    per_frame: u32,
    /// Steps made since the last frame.
    made: u32,
}

impl<R: Real, F: Form<R>> Run<R, F> {
    /// With `per_frame` steps for each of the `rate` frames of a second.
    pub fn new(&(parameters, start): &(Parameters<R>, State<R>), rate: u16, per_frame: u32) -> Self {
        let dt = 1.0 / (f64::from(rate) * f64::from(per_frame));
        Self { parameters, start, dt, motion: None, per_frame, made: 0 }
    }

    /// Prepares the steps; whether they were not.
    #[inline(never)] // once in flash
    pub fn prepare(&mut self) -> Result<bool, Error> {
        let is_new = self.motion.is_none();
        if is_new {
            self.motion = Some(Stepper::new(&self.parameters, &self.start, self.dt)?);
        }
        Ok(is_new)
    }

    /// Makes `most` of the steps towards the next frame, or as many as are left. How many that were: 0 if nothing was left to
    /// do.
    #[inline(never)] // once in flash
    pub fn advance(&mut self, most: u32) -> u32 {
        let left = self.per_frame.saturating_sub(self.made);
        let steps = if most < left { most } else { left };
        if let Some(motion) = &mut self.motion {
            motion.advance(steps);
        }
        self.made += steps;
        steps
    }

    /// The frame, when nothing is left to do; the next steps lead to the next.
    #[inline(never)] // once in flash
    pub fn frame(&mut self) -> Directions {
        self.made = 0;
        self.motion.as_ref().map_or([[f32::NAN; 2]; 2], |motion| {
            motion.directions().map(|direction| direction.map(|x| x.to_f64() as f32))
        })
    }
}

#[cfg(feature = "defmt")]
impl<R: Real + defmt::Format, F: Form<R>> defmt::Format for Run<R, F>
where
    Stepper<R, F>: defmt::Format,
{
    fn format(&self, f: defmt::Formatter) {
        let Self { parameters, start, dt, motion, per_frame, made } = self;
        defmt::write!(
            f,
            "Run {{ parameters: {}, start: {}, dt: {}, motion: {}, per_frame: {}, made: {} }}",
            parameters,
            start,
            dt,
            motion,
            per_frame,
            made
        );
    }
}

/// How far the farther of the two bobs is off, or bob 2 as seen from bob 1, where the rods are as long as `rods`, in their
/// unit; NaN if anything is.
///
/// The last keeps curves of the angles right, too: opposite errors of both may leave bob 2 where it belongs.
#[inline(never)] // once in flash
pub(super) fn distance(rods: [f32; 2], a: &Directions, b: &Directions) -> f32 {
    let difference = |rod: usize, axis: usize| rods[rod] * (a[rod][axis] - b[rod][axis]);
    let [bob1, relative] = [0, 1].map(|rod| [difference(rod, 0), difference(rod, 1)]);
    let bob2 = [bob1[0] + relative[0], bob1[1] + relative[1]];
    let [bob1, relative, bob2] = [bob1, relative, bob2].map(|[x, y]| x * x + y * y);
    libm::sqrtf(greater(greater(bob1, relative), bob2))
}

/// The greater; NaN if either is.
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b || a.is_nan() { a } else { b }
}
