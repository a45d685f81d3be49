//! The position and motion of a pendulum: angles with momenta, or angles with velocities.

use crate::error::{Error, Parameter, check_finite};
use crate::numbers::Real;

/// Angles and canonical momenta: a point of the phase space.
///
/// Angles are measured from the downward vertical, positive counter-clockwise, and are not wrapped.
/// The default, all zero, hangs at rest. Any number is accepted here; [`finite`](Self::finite) and
/// [`Pendulum::run`](crate::Pendulum::run) refuse NaN and infinity.
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// Returns a pendulum that is at rest at the angles `a1`, `a2`, rad.
    #[must_use]
    pub fn at_rest(a1: R, a2: R) -> Self {
        Self {
            a1,
            a2,
            p1: R::ZERO,
            p2: R::ZERO,
        }
    }

    /// Returns both angles (a1, a2), rad.
    #[must_use]
    pub fn angles(&self) -> [R; 2] {
        [self.a1, self.a2]
    }

    /// Returns the same numbers in the arithmetic `S`, each rounded once; infinite or zero out of
    /// its range.
    #[must_use]
    pub fn cast<S: Real>(self) -> State<S> {
        <[R; 4]>::from(self).map(R::cast).into()
    }

    /// Returns the state if all its numbers are finite, otherwise [`Error::Diverged`] with the
    /// first that is not.
    ///
    /// After a number is not finite, no number becomes finite again, so that a check before the
    /// state is used is sufficient.
    ///
    /// ```
    /// use double_pendulum::{Error, Parameters, Pendulum, State};
    ///
    /// let pendulum = Pendulum::new(&Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: 9.8 })?;
    /// let mut state = State::at_rest(3.0, 1.0);
    /// let stopped = loop {
    ///     match pendulum.step(&state, 1e3).finite() {
    ///         Ok(next) => state = next,
    ///         Err(error) => break error, // `state` is the last finite one
    ///     }
    /// };
    /// assert!(matches!(stopped, Error::Diverged { .. }) && state.finite().is_ok());
    /// # Ok::<(), Error>(())
    /// ```
    pub fn finite(self) -> Result<Self, Error> {
        self.check().map(|()| self).map_err(Error::diverged)
    }

    #[doc(hidden)] // For settings; `Pendulum::run` checks its start.
    pub fn check(&self) -> Result<(), Error> {
        check_finite([
            (Parameter::A1, self.a1),
            (Parameter::A2, self.a2),
            (Parameter::P1, self.p1),
            (Parameter::P2, self.p2),
        ])
    }
}

/// Converts from the order of `[math24]`: a1, a2, p1, p2.
impl<R> From<[R; 4]> for State<R> {
    fn from([a1, a2, p1, p2]: [R; 4]) -> Self {
        Self { a1, a2, p1, p2 }
    }
}

/// Converts to the order of `[math24]`: a1, a2, p1, p2.
impl<R> From<State<R>> for [R; 4] {
    fn from(point: State<R>) -> Self {
        [point.a1, point.a2, point.p1, point.p2]
    }
}

/// Angles and angular velocities: the variables of the Lagrangian, with w = da/dt.
///
/// Angles are as in [`State`]. [`Pendulum::to_state`](crate::Pendulum::to_state) converts to
/// canonical momenta, and [`Pendulum::to_motion`](crate::Pendulum::to_motion) back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// Returns a pendulum that is at rest at the angles `a1`, `a2`, rad.
    #[must_use]
    pub fn at_rest(a1: R, a2: R) -> Self {
        Self {
            a1,
            a2,
            w1: R::ZERO,
            w2: R::ZERO,
        }
    }

    /// Returns both angles (a1, a2), rad.
    #[must_use]
    pub fn angles(&self) -> [R; 2] {
        [self.a1, self.a2]
    }

    /// Returns the same numbers in the arithmetic `S`, each rounded once; infinite or zero out of
    /// its range.
    #[must_use]
    pub fn cast<S: Real>(self) -> Motion<S> {
        <[R; 4]>::from(self).map(R::cast).into()
    }

    #[doc(hidden)] // For settings; `Pendulum::run` checks its start.
    pub fn check(&self) -> Result<(), Error> {
        check_finite([
            (Parameter::A1, self.a1),
            (Parameter::A2, self.a2),
            (Parameter::W1, self.w1),
            (Parameter::W2, self.w2),
        ])
    }
}

/// Converts from the order of `[math24]`: a1, a2, w1, w2.
impl<R> From<[R; 4]> for Motion<R> {
    fn from([a1, a2, w1, w2]: [R; 4]) -> Self {
        Self { a1, a2, w1, w2 }
    }
}

/// Converts to the order of `[math24]`: a1, a2, w1, w2.
impl<R> From<Motion<R>> for [R; 4] {
    fn from(point: Motion<R>) -> Self {
        [point.a1, point.a2, point.w1, point.w2]
    }
}
