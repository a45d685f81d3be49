//! The two ways to say where the pendulum is and how it moves: by momenta and by velocities.

use crate::error::{Error, Parameter, check_finite};
use crate::numbers::Real;

/// Angles and canonical momenta: a point of the phase space.
///
/// Angles are measured from the downward vertical, positive counter-clockwise, and are not wrapped.
/// [`Pendulum::to_motion`](crate::Pendulum::to_motion) turns it into angular velocities.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct State<R> {
    /// Angle of rod 1, rad.
    pub a1: R,
    /// Angle of rod 2, rad.
    pub a2: R,
    /// Momentum conjugate to `a1`, kg m^2/s.
    pub p1: R,
    /// Momentum conjugate to `a2`, kg m^2/s.
    pub p2: R,
}

impl<R: Real> State<R> {
    /// Held still at the angles `a1`, `a2` (rad): both momenta are zero.
    #[must_use]
    pub fn at_rest(a1: R, a2: R) -> Self {
        Self { a1, a2, p1: R::ZERO, p2: R::ZERO }
    }

    /// Both angles, rad.
    #[must_use]
    pub fn angles(&self) -> [R; 2] {
        [self.a1, self.a2]
    }

    /// The same numbers in the arithmetic `S`, each rounded once; exact from `f32` to `f64`.
    #[must_use]
    pub fn cast<S: Real>(self) -> State<S> {
        <[R; 4]>::from(self).map(R::cast).into()
    }

    /// Refuses NaN and infinite values.
    #[inline(never)] // cold: once in flash, not once for each caller
    pub fn check(&self) -> Result<(), Error> {
        let &Self { a1, a2, p1, p2 } = self;
        check_finite([(Parameter::A1, a1), (Parameter::A2, a2), (Parameter::P1, p1), (Parameter::P2, p2)])
    }

    /// The state itself if all its numbers are finite, else [`Error::Diverged`]: to be asked after a step.
    ///
    /// A step from a good state is finite whenever it resolves the motion; one too long for it may lead anywhere
    /// ([`Modes::step_limit`](crate::Modes::step_limit) holds for small motions only). Once a number is not finite none
    /// ever is again, so it is enough to ask before the state is used.
    ///
    /// ```
    /// use double_pendulum::{Error, Parameters, Pendulum, State};
    ///
    /// let pendulum = Pendulum::new(&Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.8 })?;
    /// let mut state = State::at_rest(3.0, 1.0);
    /// let stopped = loop {
    ///     match pendulum.step(&state, 1e3).finite() {
    ///         Ok(next) => state = next,
    ///         Err(error) => break error, // and `state` is the last good one
    ///     }
    /// };
    /// assert!(matches!(stopped, Error::Diverged { .. }) && state.check().is_ok());
    /// # Ok::<(), Error>(())
    /// ```
    pub fn finite(self) -> Result<Self, Error> {
        self.check().map(|()| self).map_err(Error::diverged)
    }
}

/// In the book's order: a1, a2, p1, p2.
impl<R> From<[R; 4]> for State<R> {
    fn from([a1, a2, p1, p2]: [R; 4]) -> Self {
        Self { a1, a2, p1, p2 }
    }
}

/// In the book's order: a1, a2, p1, p2.
impl<R> From<State<R>> for [R; 4] {
    fn from(State { a1, a2, p1, p2 }: State<R>) -> Self {
        [a1, a2, p1, p2]
    }
}

/// Angles and angular velocities: the Lagrangian's variables, w = da/dt.
///
/// Angles as in [`State`]; [`Pendulum::to_state`](crate::Pendulum::to_state) turns it into canonical momenta.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Motion<R> {
    /// Angle of rod 1, rad.
    pub a1: R,
    /// Angle of rod 2, rad.
    pub a2: R,
    /// Angular velocity of rod 1, rad/s.
    pub w1: R,
    /// Angular velocity of rod 2, rad/s.
    pub w2: R,
}

impl<R: Real> Motion<R> {
    /// Held still at the angles `a1`, `a2` (rad).
    #[must_use]
    pub fn at_rest(a1: R, a2: R) -> Self {
        Self { a1, a2, w1: R::ZERO, w2: R::ZERO }
    }

    /// Both angles, rad.
    #[must_use]
    pub fn angles(&self) -> [R; 2] {
        [self.a1, self.a2]
    }

    /// The same numbers in the arithmetic `S`, each rounded once; exact from `f32` to `f64`.
    #[must_use]
    pub fn cast<S: Real>(self) -> Motion<S> {
        <[R; 4]>::from(self).map(R::cast).into()
    }

    /// Refuses NaN and infinite values.
    #[inline(never)] // cold: once in flash, not once for each caller
    pub fn check(&self) -> Result<(), Error> {
        let &Self { a1, a2, w1, w2 } = self;
        check_finite([(Parameter::A1, a1), (Parameter::A2, a2), (Parameter::W1, w1), (Parameter::W2, w2)])
    }
}

/// In the book's order: a1, a2, w1, w2.
impl<R> From<[R; 4]> for Motion<R> {
    fn from([a1, a2, w1, w2]: [R; 4]) -> Self {
        Self { a1, a2, w1, w2 }
    }
}

/// In the book's order: a1, a2, w1, w2.
impl<R> From<Motion<R>> for [R; 4] {
    fn from(Motion { a1, a2, w1, w2 }: Motion<R>) -> Self {
        [a1, a2, w1, w2]
    }
}
