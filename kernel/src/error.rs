//! The errors of the kernel: which value is refused, and why.

use core::fmt;

use crate::numbers::Real;
use crate::table::Method;

/// A quantity that an [`Error`] names: an input, or a number of a motion. Displays as its symbol in
/// `[math24]`, such as `m1`, or in words, such as `frequency ratio`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Parameter {
    /// Mass of bob 1, kg.
    M1,
    /// Mass of bob 2, kg.
    M2,
    /// Length of rod 1, m.
    L1,
    /// Length of rod 2, m.
    L2,
    /// Gravitational acceleration, m/s^2.
    G,
    /// Angle of rod 1, rad.
    A1,
    /// Angle of rod 2, rad.
    A2,
    /// Angular velocity of rod 1, rad/s.
    W1,
    /// Angular velocity of rod 2, rad/s.
    W2,
    /// Momentum conjugate to `a1`, kg m^2/s.
    P1,
    /// Momentum conjugate to `a2`, kg m^2/s.
    P2,
    /// Step size, s; negative if time runs backwards.
    Dt,
    /// Order of an extrapolation.
    Order,
    /// Ratio of the normal frequencies, fast over slow.
    FrequencyRatio,
    /// Energy H of a motion ([`Pendulum::energy`](crate::Pendulum::energy)), J.
    Energy,
    /// The method itself, which is not a number.
    Method,
    /// Largest allowed distance of a bob from its exact position, m.
    Tolerance,
    /// Duration of the motion that is shown, s.
    Duration,
    /// Frames per second.
    Rate,
    /// Cost of a step, of a frame by the closed form, or of preparing a motion, in the unit of the
    /// price list.
    Cost,
    /// Price of a step by this method, or of a frame by the closed form.
    Price(Method),
    /// Price of preparing a motion.
    Preparation,
    /// Price of comparing a frame.
    Comparison,
    /// Largest allowed cost of computing a frame.
    FrameBudget,
    /// Largest allowed cost of planning.
    PlanningBudget,
}

impl Parameter {
    /// Returns the SI unit after a space, to follow a value; empty for a plain number or a cost.
    const fn unit(self) -> &'static str {
        match self {
            Parameter::M1 | Parameter::M2 => " kg",
            Parameter::L1 | Parameter::L2 | Parameter::Tolerance => " m",
            Parameter::G => " m/s^2",
            Parameter::A1 | Parameter::A2 => " rad",
            Parameter::W1 | Parameter::W2 => " rad/s",
            Parameter::P1 | Parameter::P2 => " kg m^2/s",
            Parameter::Dt | Parameter::Duration => " s",
            Parameter::Energy => " J",
            _ => "",
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Parameter::M1 => "m1",
            Parameter::M2 => "m2",
            Parameter::L1 => "l1",
            Parameter::L2 => "l2",
            Parameter::G => "g",
            Parameter::A1 => "a1",
            Parameter::A2 => "a2",
            Parameter::W1 => "w1",
            Parameter::W2 => "w2",
            Parameter::P1 => "p1",
            Parameter::P2 => "p2",
            Parameter::Dt => "dt",
            Parameter::Order => "order",
            Parameter::FrequencyRatio => "frequency ratio",
            Parameter::Energy => "energy",
            Parameter::Method => "method",
            Parameter::Tolerance => "tolerance",
            Parameter::Duration => "duration",
            Parameter::Rate => "rate",
            Parameter::Cost => "cost",
            Parameter::Price(method) => return write!(f, "cost of {method}"),
            Parameter::Preparation => "cost of a preparation",
            Parameter::Comparison => "cost of a comparison",
            Parameter::FrameBudget => "frame budget",
            Parameter::PlanningBudget => "planning budget",
        })
    }
}

/// The reason why an input is refused, or why a motion cannot go on: the parameter and its value,
/// in the unit of the [`Parameter`], except for [`Diverged`](Self::Diverged). Displays as one line,
/// such as `l1 = 0.0 m: must be greater than zero`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Error {
    /// The value is NaN or infinite. Also the error for a mass, length, gravity or start that
    /// becomes infinite in the numbers of the method; the value is then infinite.
    NotFinite {
        /// The refused parameter.
        parameter: Parameter,
        /// The refused value.
        value: f64,
    },
    /// The value is zero or negative. Also the error for a mass or length that becomes zero in the
    /// numbers of the method; the value is then 0. Gravity is refused by it only if it is 0 and
    /// normal modes are needed.
    NotPositive {
        /// The refused parameter.
        parameter: Parameter,
        /// The refused value.
        value: f64,
    },
    /// The value exceeds a limit, which usually follows from the other parameters.
    TooLarge {
        /// The refused parameter.
        parameter: Parameter,
        /// The refused value.
        value: f64,
        /// The largest possible value; of a step, which may be negative, the largest magnitude.
        limit: f64,
    },
    /// The value is below a limit: a finite gravity below 0, or a frequency ratio too small for the
    /// rods.
    TooSmall {
        /// The refused parameter.
        parameter: Parameter,
        /// The refused value.
        value: f64,
        /// The smallest possible value. A frequency ratio must exceed it.
        limit: f64,
    },
    /// Every input was valid, but the motion has left the finite numbers or the range of its
    /// method. A step was too long for it or, by the closed form, the time since the start.
    Diverged {
        /// The first quantity that is out of range. `A1` and `A2` also represent the direction of
        /// their rod. In fixed point always `A1`.
        parameter: Parameter,
        /// A number that is out of range: NaN or infinite, the length of a direction, or an energy,
        /// J. NaN in fixed point.
        value: f64,
    },
    /// Each value alone is valid, but one of them or a product of them leaves the range of the
    /// arithmetic.
    ///
    /// Also the error for a step that is zero, subnormal or infinite in the numbers of the method,
    /// for an order that is not 2, 4 .. 16, and for a start of 2^31 - 1 turns or more. Only
    /// [`Pendulum::check_step`](crate::Pendulum::check_step) and
    /// [`Modes::check_step`](crate::Modes::check_step) refuse a zero step by `NotPositive`.
    OutOfRange {
        /// The refused parameter. If a product is out of range, the mass, length or gravity whose
        /// value is farthest from 1 as a factor.
        parameter: Parameter,
        /// The refused value.
        value: f64,
    },
    /// The misprinted equations of `[math24]` are for equal rods, but these rods differ.
    UnequalRods {
        /// Length of rod 1, m.
        l1: f64,
        /// Length of rod 2, m.
        l2: f64,
    },
    /// No scene can be drawn by the method, because it is not in [`Method::DRAWN`].
    NotDrawn {
        /// The refused method.
        method: Method,
    },
}

impl Error {
    /// Returns the parameter of the error: `L2` for unequal rods, `Method` for a method that is not
    /// drawn.
    #[must_use]
    pub const fn parameter(&self) -> Parameter {
        match *self {
            Error::NotFinite { parameter, .. }
            | Error::NotPositive { parameter, .. }
            | Error::TooLarge { parameter, .. }
            | Error::TooSmall { parameter, .. }
            | Error::Diverged { parameter, .. }
            | Error::OutOfRange { parameter, .. } => parameter,
            Error::UnequalRods { .. } => Parameter::L2,
            Error::NotDrawn { .. } => Parameter::Method,
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = self.parameter().unit();
        match self {
            Error::NotFinite { parameter, value } => {
                write!(f, "{parameter} = {value:?}: must be a finite number")
            }
            Error::NotPositive { parameter, value } => {
                write!(
                    f,
                    "{parameter} = {value:?}{unit}: must be greater than zero"
                )
            }
            Error::TooLarge {
                parameter,
                value,
                limit,
            } => write!(
                f,
                "{parameter} = {value:?}{unit}: must not exceed {limit:?}{unit}"
            ),
            Error::TooSmall {
                parameter,
                value,
                limit,
            } => {
                let relation = if *parameter == Parameter::FrequencyRatio {
                    "exceed"
                } else {
                    "be at least"
                };
                write!(
                    f,
                    "{parameter} = {value:?}{unit}: must {relation} {limit:?}{unit}"
                )
            }
            Error::Diverged { parameter, value } => write!(
                f,
                "{parameter} = {value:?}: the motion has diverged; \
                 use a shorter step or, for the closed form, a shorter time"
            ),
            Error::OutOfRange {
                parameter: Parameter::Dt,
                value: 0.0,
            } => f.write_str("dt = 0.0 s: must not be zero"),
            Error::OutOfRange { parameter, value } => write!(
                f,
                "{parameter} = {value:?}{unit}: too large or too small for this arithmetic, \
                 together with the other values; use less extreme values"
            ),
            Error::UnequalRods { l1, l2 } => {
                write!(
                    f,
                    "l2 = {l2:?}{unit}: must equal l1 = {l1:?}{unit}; \
                     these equations are for rods of equal length"
                )
            }
            Error::NotDrawn { method } => {
                write!(
                    f,
                    "{method}: not a method for drawing; choose one of `Method::DRAWN`"
                )
            }
        }
    }
}

impl Error {
    /// Turns the refusal of a computed value into [`Error::Diverged`].
    pub(crate) fn diverged(self) -> Self {
        match self {
            Error::NotFinite { parameter, value } => Error::Diverged { parameter, value },
            other => other,
        }
    }
}

impl core::error::Error for Error {}

/// Refuses the first of `values` that is NaN or infinite, by [`Error::NotFinite`].
pub(crate) fn check_finite<R: Real>(
    values: impl IntoIterator<Item = (Parameter, R)>,
) -> Result<(), Error> {
    match values.into_iter().find(|(_, value)| !value.is_finite()) {
        Some((parameter, value)) => Err(Error::NotFinite {
            parameter,
            value: value.to_f64(),
        }),
        None => Ok(()),
    }
}
