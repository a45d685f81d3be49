//! What the caller gives, checked once: masses, lengths and gravity; where the pendulum is and how it moves, by momenta or by
//! velocities.

use crate::error::{Error, Parameter, check_finite};
use crate::numbers::Real;

/// The five constants of a double pendulum, SI units, as the caller gives them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Parameters<R> {
    /// Mass of bob 1, kg.
    pub m1: R,
    /// Mass of bob 2, kg.
    pub m2: R,
    /// Length of rod 1, m.
    pub l1: R,
    /// Length of rod 2, m.
    pub l2: R,
    /// Gravitational acceleration, m/s^2; zero is allowed.
    pub g: R,
}

impl<R: Real> Parameters<R> {
    /// Equal rods of length `l` and a bob 1 of 1 kg, so that only the mass ratio mu = m2/m1 is left to choose.
    ///
    /// With `l` and `g` of 1 the equations are the book's dimensionless ones for equal rods: time is counted in sqrt(l/g),
    /// momenta in m1 l^2 sqrt(g/l), energy in m1 g l.
    #[must_use]
    pub fn equal_rods(mu: R, l: R, g: R) -> Self {
        Self {
            m1: R::ONE,
            m2: mu,
            l1: l,
            l2: l,
            g,
        }
    }

    /// The mass ratio mu = m2/m1.
    #[must_use]
    pub fn mass_ratio(&self) -> R {
        self.m2 / self.m1
    }

    /// The same numbers in the arithmetic `S`, each rounded once; exact from `f32` to `f64`.
    ///
    /// Check them there: what is large in `f64` may be infinite in `f32`.
    #[must_use]
    pub fn cast<S: Real>(self) -> Parameters<S> {
        let Self { m1, m2, l1, l2, g } = self;
        let [m1, m2, l1, l2, g] = [m1, m2, l1, l2, g].map(R::cast);
        Parameters { m1, m2, l1, l2, g }
    }

    /// Refuses what no formula could use: NaN, infinite, zero or negative masses and lengths, negative gravity.
    #[inline(never)] // cold, and never inlined, to avoid a second copy
    pub(crate) fn check(&self) -> Result<(), Error> {
        for (parameter, value) in self.named() {
            if !value.is_finite() {
                return Err(Error::NotFinite { parameter, value });
            }
            if value < 0.0 && parameter == Parameter::G {
                return Err(Error::TooSmall {
                    parameter,
                    value,
                    limit: 0.0,
                });
            }
            if value <= 0.0 && parameter != Parameter::G {
                return Err(Error::NotPositive { parameter, value });
            }
        }
        Ok(())
    }

    /// The error for parameters whose products overflow or underflow: it names the value farthest from 1.
    #[inline(never)] // cold, and never inlined, to avoid a second copy
    pub(crate) fn out_of_range(&self) -> Error {
        let distance = |value: f64| if value < 1.0 { 1.0 / value } else { value };
        let [first, rest @ ..] = self.named();
        let (parameter, value) =
            rest.into_iter()
                .filter(|(_, value)| *value != 0.0)
                .fold(first, |worst, next| {
                    if distance(next.1) > distance(worst.1) {
                        next
                    } else {
                        worst
                    }
                });
        Error::OutOfRange { parameter, value }
    }

    fn named(&self) -> [(Parameter, f64); 5] {
        [
            (Parameter::M1, self.m1.to_f64()),
            (Parameter::M2, self.m2.to_f64()),
            (Parameter::L1, self.l1.to_f64()),
            (Parameter::L2, self.l2.to_f64()),
            (Parameter::G, self.g.to_f64()),
        ]
    }
}

macro_rules! both_rods {
    ($(#[$about:meta])* $point:ident: $a1:ident, $a2:ident, $x1:ident $X1:ident $first:literal, $x2:ident $X2:ident $second:literal) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct $point<R> {
            /// Angle of rod 1, rad.
            pub $a1: R,
            /// Angle of rod 2, rad.
            pub $a2: R,
            #[doc = $first]
            pub $x1: R,
            #[doc = $second]
            pub $x2: R,
        }

        impl<R: Real> $point<R> {
            /// Held still at the angles `a1`, `a2`, rad.
            #[must_use]
            pub fn at_rest($a1: R, $a2: R) -> Self {
                Self { $a1, $a2, $x1: R::ZERO, $x2: R::ZERO }
            }

            /// Both angles, rad.
            #[must_use]
            pub fn angles(&self) -> [R; 2] {
                [self.$a1, self.$a2]
            }

            /// The same numbers in the arithmetic `S`, each rounded once; exact from `f32` to `f64`.
            #[must_use]
            pub fn cast<S: Real>(self) -> $point<S> {
                <[R; 4]>::from(self).map(R::cast).into()
            }

            /// Refuses NaN and infinite values.
            #[inline(never)] // cold, and never inlined, to avoid a second copy
            #[doc(hidden)]
            pub fn check(&self) -> Result<(), Error> {
                let &Self { $a1, $a2, $x1, $x2 } = self;
                check_finite([(Parameter::A1, $a1), (Parameter::A2, $a2), (Parameter::$X1, $x1), (Parameter::$X2, $x2)])
            }
        }

        /// Angles first, as the book has them.
        impl<R> From<[R; 4]> for $point<R> {
            fn from([$a1, $a2, $x1, $x2]: [R; 4]) -> Self {
                Self { $a1, $a2, $x1, $x2 }
            }
        }

        /// Angles first, as the book has them.
        impl<R> From<$point<R>> for [R; 4] {
            fn from($point { $a1, $a2, $x1, $x2 }: $point<R>) -> Self {
                [$a1, $a2, $x1, $x2]
            }
        }
    };
}

both_rods! {
    /// Angles and canonical momenta: a point of the phase space.
    ///
    /// Angles are measured from the downward vertical, positive counter-clockwise, and are not wrapped.
    /// [`Pendulum::to_motion`](crate::Pendulum::to_motion) turns it into angular velocities.
    #[cfg_attr(feature = "defmt", derive(defmt::Format))]
    #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
    State: a1, a2, p1 P1 "Momentum conjugate to `a1`, kg m^2/s.", p2 P2 "Momentum conjugate to `a2`, kg m^2/s."
}

both_rods! {
    /// Angles and angular velocities: the Lagrangian's variables, w = da/dt.
    ///
    /// Angles as in [`State`]; [`Pendulum::to_state`](crate::Pendulum::to_state) turns it into canonical momenta.
    Motion: a1, a2, w1 W1 "Angular velocity of rod 1, rad/s.", w2 W2 "Angular velocity of rod 2, rad/s."
}

impl<R: Real> State<R> {
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
