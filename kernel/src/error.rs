//! What the kernel refuses, and why.

use core::fmt;

use crate::numbers::Real;
use crate::table::Method;

macro_rules! parameters {
    ($($(#[$hidden:meta])? $name:ident $symbol:literal $doc:literal;)*) => {
        /// A quantity the caller chooses. Displays as the book's symbol.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[non_exhaustive]
        pub enum Parameter { $($(#[$hidden])? #[doc = $doc] $name,)* }

        impl fmt::Display for Parameter {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $(Parameter::$name => $symbol,)* })
            }
        }
    };
}

parameters! {
    M1 "m1" "Mass of bob 1, kg.";
    M2 "m2" "Mass of bob 2, kg.";
    L1 "l1" "Length of rod 1, m.";
    L2 "l2" "Length of rod 2, m.";
    G "g" "Gravitational acceleration, m/s^2.";
    A1 "a1" "Angle of rod 1, rad.";
    A2 "a2" "Angle of rod 2, rad.";
    W1 "w1" "Angular velocity of rod 1, rad/s.";
    W2 "w2" "Angular velocity of rod 2, rad/s.";
    P1 "p1" "Momentum conjugate to `a1`, kg m^2/s.";
    P2 "p2" "Momentum conjugate to `a2`, kg m^2/s.";
    Dt "dt" "Step of time, s.";
    Order "order" "Order of a method.";
    FrequencyRatio "frequency ratio" "Ratio of the normal frequencies, fast over slow.";
    #[doc(hidden)] Energy "energy" "The energy, J.";
    Method "method" "The method.";
    Tolerance "tolerance" "How far a bob may be off, m.";
    Duration "duration" "How long a motion is shown, s.";
    Rate "rate" "Frames per second.";
    Cost "cost" "What a step costs, in the unit of the budget.";
    Budget "budget" "What computing a frame, or planning, may cost.";
}

macro_rules! errors {
    ($($variant:ident { $parameter:ident, $value:ident $(, $limit:ident)? } $doc:literal $reason:literal;)*) => {
        /// Why an input is refused: the parameter and the value it had.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[cfg_attr(feature = "defmt", derive(defmt::Format))]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[non_exhaustive]
        pub enum Error {
            $(#[doc = $doc]
            $variant {
                /// The offending parameter.
                $parameter: Parameter,
                /// Its value.
                $value: f64,
                $(/// The most or the least there may be.
                $limit: f64,)?
            },)*
            /// The book's misprinted equations are of equal rods, but these differ; names rod 2.
            UnequalRods {
                /// Length of rod 1, m.
                l1: f64,
                /// Length of rod 2, m.
                l2: f64,
            },
            /// A plan does not choose from it: none of [`Method::DRAWN`].
            NotDrawn {
                /// The method.
                method: Method,
            },
        }

        impl Error {
            /// The offending parameter.
            #[must_use]
            pub const fn parameter(&self) -> Parameter {
                match *self {
                    $(Error::$variant { $parameter, .. } => $parameter,)*
                    Error::UnequalRods { .. } => Parameter::L2,
                    Error::NotDrawn { .. } => Parameter::Method,
                }
            }
        }

        impl fmt::Display for Error {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self {
                    $(Error::$variant { $parameter, $value $(, $limit)? } => {
                        write!(f, "{} = {:?}: ", $parameter, $value)?;
                        write!(f, $reason)
                    })*
                    Error::UnequalRods { l1, l2 } => write!(f, "l2 = {l2:?}: the equal-rod form needs l2 = l1 = {l1:?}"),
                    Error::NotDrawn { method } => write!(f, "{method}: not a method that frames are drawn by"),
                }
            }
        }
    };
}

#[rustfmt::skip]
errors! {
    NotFinite { parameter, value } "NaN or infinite." "must be a finite number";
    NotPositive { parameter, value } "Must be greater than zero." "must be greater than zero";
    TooLarge { parameter, value, limit } "Must not exceed a limit that the other parameters set." "must not exceed {limit:?}";
    TooSmall { parameter, value, limit } "Must not fall below a limit that the other parameters set." "must be at least {limit:?}";
    Diverged { parameter, value }
        "Every input was good, but a step was too long for the motion and led out of the finite numbers: the first that is none."
        "the motion has left the finite numbers; the step is too long for it";
    OutOfRange { parameter, value }
        "Each value alone is fine, but a product of them leaves the range of the arithmetic; names the value farthest from 1."
        "too extreme for this arithmetic in combination with the others";
}

impl Error {
    /// The same of a result, where it was of an input.
    pub(crate) fn diverged(self) -> Self {
        match self {
            Error::NotFinite { parameter, value } => Error::Diverged { parameter, value },
            other => other,
        }
    }
}

impl core::error::Error for Error {}

/// Refuses the first of `values` that is NaN or infinite.
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
