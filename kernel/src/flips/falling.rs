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
    /// The sides of the rods after the last step
    /// ([`sides`](crate::methods::Advance::sides)).
    sides: [[i32; 2]; 2],
    /// The number of steps since the start, without the step of the flip.
    pub steps: u32,
}

impl<F: Form> Falling<F> {
    /// Returns the motion of `map` that is released at rest at the angles `a1`, `a2`, rad; `None`
    /// if the energy is too low for any flip. Without gravity the result is a motion, which stays
    /// at rest.
    ///
    /// # Errors
    ///
    /// Refuses angles that are not finite, by [`Error::NotFinite`], and, by the closed form, a
    /// start from which an angle may exceed 2^31 - 1 turns, by [`Error::OutOfRange`].
    pub fn start(map: &Flips<F>, a1: F::Real, a2: F::Real) -> Result<Option<Self>, Error> {
        let state = State::at_rest(a1, a2);
        state.check()?;

        // With too little energy for a flip, no motion has to be computed.
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

    /// Computes at most `steps` steps. Returns the result once it is known, and `None` until then:
    /// [`Flip::After`], whose time is negative if the map runs backwards, or [`Flip::Later`] in the
    /// first call that would exceed the steps of `map`. After exactly these steps, and for 0
    /// `steps`, the result is `None`.
    ///
    /// `map` must be the map of the start, and the method must not be called again after a result;
    /// neither is checked. Nor is the motion: if it diverges, it may have any of these results.
    pub fn advance(&mut self, map: &Flips<F>, steps: u32) -> Option<Flip<F::Real>> {
        for _ in 0..steps {
            if self.steps >= map.steps {
                return Some(Flip::Later);
            }
            self.motion.advance_one();

            // Both rods are tested after each step.
            let before = core::mem::replace(&mut self.sides, self.motion.sides());
            if passes(&before, &self.sides) < 0 {
                return Some(map.passage(self.steps, before, self.sides));
            }
            self.steps += 1;
        }
        None
    }
}
