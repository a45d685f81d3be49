//! The constants of a pendulum, chosen by the caller.

use crate::error::{Error, Parameter};
use crate::numbers::Real;

/// The least and the greatest mass, kg, length, m, and gravity, m/s^2.
const LEAST: f64 = 1e-9;
const GREATEST: f64 = 1e9;

/// The five constants of a double pendulum, in SI units, chosen by the caller.
///
/// Masses and lengths are from 1e-9 to 1e9 kg and m. Gravity is 0, or from 1e-9 to 1e9 m/s^2. In
/// this range, which [`Pendulum::new`](crate::Pendulum::new) checks, no product of the equations
/// overflows or underflows, also in `f32`.
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
    /// Returns equal rods of length `l`, m, a bob 1 of 1 kg, and a bob 2 of `mu` kg: mu = m2/m1.
    /// The gravitational acceleration is `g`, m/s^2.
    ///
    /// With `l` = `g` = 1 the equations are the dimensionless equations of `[math24]` for equal
    /// rods: the unit of time is then sqrt(l/g) of the real pendulum, that of momenta m1 l^2
    /// sqrt(g/l), and that of energy m1 g l.
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

    /// Returns the mass ratio mu = m2/m1, unchecked.
    #[must_use]
    pub fn mass_ratio(&self) -> R {
        self.m2 / self.m1
    }

    /// Returns the same numbers in the arithmetic `S`, each rounded once. A large number in `f64`
    /// can be infinite in `f32`, a small one 0.
    #[must_use]
    pub fn cast<S: Real>(self) -> Parameters<S> {
        let Self { m1, m2, l1, l2, g } = self;
        let [m1, m2, l1, l2, g] = [m1, m2, l1, l2, g].map(R::cast);
        Parameters { m1, m2, l1, l2, g }
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        for (parameter, value) in self.named() {
            let is_gravity = parameter == Parameter::G;
            if !value.is_finite() {
                return Err(Error::NotFinite { parameter, value });
            }
            if is_gravity && value == 0.0 {
                continue;
            }
            if value <= 0.0 && !is_gravity {
                return Err(Error::NotPositive { parameter, value });
            }
            // The limits are those of `R`: as an `f32`, 1e9 is exact and 1e-9 is not.
            let [least, greatest] = [LEAST, GREATEST].map(|limit| R::from_f64(limit).to_f64());
            if value < least {
                return Err(Error::TooSmall {
                    parameter,
                    value,
                    limit: if value < 0.0 { 0.0 } else { LEAST },
                });
            }
            if value > greatest {
                return Err(Error::TooLarge {
                    parameter,
                    value,
                    limit: GREATEST,
                });
            }
        }
        Ok(())
    }

    /// Returns [`Error::OutOfRange`] for parameters whose products overflow or underflow. It names
    /// the value that is farthest from 1 as a factor.
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
