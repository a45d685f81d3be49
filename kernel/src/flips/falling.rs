//! A motion that is searched for its first flip, a few steps at a time.

use super::{Flip, Flips, passes};
use crate::error::Error;
use crate::methods::Form;
use crate::pendulum::State;

/// A motion that has not flipped yet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Falling<F: Form> {
    /// The motion after [`steps`](Self::steps) steps; one step later once a rod has flipped.
    pub(super) motion: F,
    sides: [[i32; 2]; 2],
    /// The number of steps, without the step of the flip.
    pub steps: u32,
}

impl<F: Form> Falling<F> {
    /// Returns the motion of `map` that is released at rest at these angles; `None` if the energy
    /// is too low for any flip.
    pub fn start(map: &Flips<F>, a1: F::Real, a2: F::Real) -> Result<Option<Self>, Error> {
        let state = State::at_rest(a1, a2);
        state.check()?;

        if map.pendulum.cannot_turn_over(&state) {
            return Ok(None);
        }
        let motion = map.highest.started(&state.cast())?;
        Ok(Some(Self {
            motion,
            sides: motion.sides(),
            steps: 0,
        }))
    }

    /// Computes at most `steps` steps, and returns the result once it is known: [`Flip::Later`] in
    /// the first call that would exceed the steps of `map`. `map` is the map of the start; do not
    /// call again after a result.
    pub fn advance(&mut self, map: &Flips<F>, steps: u32) -> Option<Flip<F::Real>> {
        for _ in 0..steps {
            if self.steps >= map.steps {
                return Some(Flip::Later);
            }
            self.motion.advance_one();

            let before = core::mem::replace(&mut self.sides, self.motion.sides());
            if passes(&before, &self.sides) < 0 {
                return Some(map.passage(self.steps, before, self.sides));
            }
            self.steps += 1;
        }
        None
    }
}
