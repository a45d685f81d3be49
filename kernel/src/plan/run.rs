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
pub(super) struct Run<R: Real, F: Form<R>> {
    motion: Motion<R, F>,
    per_frame: u32,
    /// Steps made since the last frame.
    made: u32,
}

/// Before its steps are prepared, and from then on.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion<R: Real, F: Form<R>> {
    /// A pendulum and its start, others if these are refused, and the step, s.
    Given([(Parameters<R>, State<R>); 2], f64),
    Prepared(Stepper<R, F>),
}

impl<R: Real, F: Form<R>> Run<R, F> {
    /// A pendulum and its start, or the others if the first are refused, with `per_frame` steps for each of the `rate` frames of
    /// a second.
    #[inline(never)] // once in flash
    pub fn new(given: [(Parameters<R>, State<R>); 2], rate: u16, per_frame: u32) -> Self {
        let dt = 1.0 / (f64::from(rate) * f64::from(per_frame));
        Self { motion: Motion::Given(given, dt), per_frame, made: 0 }
    }

    /// Prepares the steps; whether they were not.
    #[inline(never)] // once in flash
    pub fn prepare(&mut self) -> Result<bool, Error> {
        let Motion::Given(given, dt) = &self.motion else { return Ok(false) };
        let [first, other] = given.each_ref().map(|(parameters, start)| move || Stepper::new(parameters, start, *dt));
        self.motion = Motion::Prepared(first().or_else(|_| other())?);
        Ok(true)
    }

    /// Makes `most` of the steps towards the next frame, or as many as are left. How many that were: 0 if nothing was left to
    /// do.
    #[inline(never)] // once in flash
    pub fn advance(&mut self, most: u32) -> u32 {
        let left = self.per_frame.saturating_sub(self.made);
        let steps = if most < left { most } else { left };
        if let Motion::Prepared(motion) = &mut self.motion {
            motion.advance(steps);
        }
        self.made += steps;
        steps
    }

    /// The frame, when nothing is left to do; the next steps lead to the next.
    #[inline(never)] // once in flash
    pub fn frame(&mut self) -> Directions {
        self.made = 0;
        match &self.motion {
            Motion::Given(..) => [[f32::NAN; 2]; 2],
            Motion::Prepared(motion) => motion.directions().map(|direction| direction.map(|x| x.to_f64() as f32)),
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Bob 2 is where both rods lead, and may be less far off than either.
    #[test]
    fn the_farthest_of_what_is_seen_counts() {
        let from = |a: Directions| distance([2.0, 3.0], &a, &[[0.0; 2]; 2]);
        assert_eq!(from([[1.0, 0.0], [0.0, 1.0]]), 13.0_f32.sqrt());
        assert_eq!(from([[0.5, 0.0], [1.0, 0.0]]), 4.0);
        assert_eq!(from([[3.0, 0.0], [-1.0, 0.0]]), 6.0);
        assert_eq!(from([[0.0, 1.0], [0.0, -2.0]]), 6.0);
        assert!(from([[0.0, f32::NAN], [0.0, 1.0]]).is_nan());
    }
}
