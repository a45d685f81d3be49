//! Motions whose method is chosen at run time.

use super::{
    ClosedFormF32, ClosedFormF64, DirectionF32, DirectionF32Plain, ExtrapolationF64, Fixed32,
    Fixed64, Form, HamiltonF32, HamiltonF64,
};
use super::{extrapolation_fixed64, rk4_fixed32};
use crate::error::Error;
use crate::pendulum::{Parameters, State};
use crate::table::{Method, table};

/// Defines an enum of motions, with a variant for each of some methods, one of which is chosen at
/// run time. It implements [`Advance`](crate::parts::Advance), and links only these methods. `new`
/// refuses others by [`Error::NotDrawn`](crate::Error::NotDrawn).
#[doc(hidden)] // For the firmware.
#[macro_export]
macro_rules! motions {
    (
        $(#[$attribute:meta])*
        $visibility:vis enum $motion:ident {
            $($method:ident($form:ty),)*
        }
    ) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $visibility enum $motion {
            $(
                #[doc = concat!("`Method::", stringify!($method), "`.")]
                $method($form),
            )*
        }

        impl $motion {
            /// The methods, in the order of the variants.
            #[allow(dead_code)] // Not every user needs it.
            $visibility const METHODS: &[$crate::Method] = &[$($crate::Method::$method),*];

            #[inline(never)] // Inlined, the motions of all kinds would share a stack frame.
            $visibility fn new(
                method: $crate::Method,
                parameters: &$crate::Parameters<f64>,
                start: &$crate::State<f64>,
                dt: f64,
            ) -> Result<Self, $crate::Error> {
                match method {
                    $(
                        $crate::Method::$method => {
                            $crate::parts::start(parameters, start, dt).map(Self::$method)
                        }
                    )*
                    method => Err($crate::Error::NotDrawn { method }),
                }
            }
        }

        impl $crate::parts::Advance for $motion {
            fn started(&self, start: &$crate::State<f64>) -> Result<Self, $crate::Error> {
                match self {
                    $(Self::$method(motion) => motion.started(start).map(Self::$method),)*
                }
            }

            #[inline(never)] // Inlined, each caller would have a copy of every step.
            fn advance(&mut self, steps: u32) {
                match self {
                    $(Self::$method(motion) => $crate::parts::advance(motion, steps),)*
                }
            }

            fn check(&self) -> Result<(), $crate::Error> {
                match self {
                    $(Self::$method(motion) => motion.check(),)*
                }
            }

            fn sides(&self) -> [[i32; 2]; 2] {
                match self {
                    $(Self::$method(motion) => motion.sides(),)*
                }
            }

            fn directions<Q: $crate::Real>(&self) -> [$crate::Direction<Q>; 2] {
                match self {
                    $(Self::$method(motion) => motion.directions(),)*
                }
            }

            fn momenta<Q: $crate::Real>(&self) -> [Q; 2] {
                match self {
                    $(Self::$method(motion) => motion.momenta(),)*
                }
            }

            fn state(&self) -> $crate::State<f64> {
                match self {
                    $(Self::$method(motion) => motion.state(),)*
                }
            }

            fn energy_above_rest(&self, pendulum: &$crate::Pendulum<f64>) -> f64 {
                match self {
                    $(Self::$method(motion) => motion.energy_above_rest(pendulum),)*
                }
            }

            fn has_turns(&self) -> bool {
                match self {
                    $(Self::$method(motion) => motion.has_turns(),)*
                }
            }
        }
    };
}

/// Creates a motion, for [`motions!`].
#[inline(never)] // Inlined, each enum would have a copy.
pub fn start<F: Form>(
    parameters: &Parameters<f64>,
    start: &State<f64>,
    dt: f64,
) -> Result<F, Error> {
    F::new(parameters, start, dt)
}

/// Advances a motion, for [`motions!`].
#[inline(never)] // Inlined, each enum would have a copy.
pub fn advance<F: Form>(motion: &mut F, steps: u32) {
    motion.advance(steps);
}

/// Returns the longest step, s, that a method of [`Method::DRAWN`] accepts for a motion with `energy`
/// joules above rest; infinite in floating point.
pub(crate) fn longest_step(
    method: Method,
    parameters: &Parameters<f64>,
    energy: f64,
) -> Result<f64, Error> {
    if !energy.is_finite() {
        return Err(parameters.out_of_range());
    }
    match method {
        Method::Rk4Fixed32 => rk4_fixed32::longest_step(parameters, energy),
        Method::Extrapolation10Fixed64 => extrapolation_fixed64::longest_step(parameters, energy),
        _ => Ok(f64::INFINITY),
    }
}

motions! {
    /// A motion by a method of [`Method::DRAWN`].
    #[expect(
        clippy::large_enum_variant,
        reason = "without a heap there is nowhere else to keep it"
    )]
    pub(crate) enum DrawnMotion {
        Rk4F32Direction(DirectionF32),
        Rk4F32DirectionPlain(DirectionF32Plain),
        Rk4Fixed32(Fixed32),
        Extrapolation10Fixed64(Motion64),
        ClosedFormF32(ClosedFormF32),
    }
}

motions! {
    /// A motion by a method of [`Method::DRAWN`] in 32 bits: a third of the memory of a
    /// [`DrawnMotion`].
    pub(crate) enum Motion32 {
        Rk4F32Direction(DirectionF32),
        Rk4F32DirectionPlain(DirectionF32Plain),
        Rk4Fixed32(Fixed32),
        ClosedFormF32(ClosedFormF32),
    }
}

/// A motion by the method of [`Method::DRAWN`] in 64 bits, `extrapolation10-fixed64`.
///
/// Order 8 has a shorter accuracy horizon. Order 12 costs 1.4 times as much, and its horizon is no
/// longer, because rounding errors end it.
pub type Motion64 = Fixed64<10>;

impl Method {
    /// The methods that draw scenes, in the order of the table. A [plan](crate::plan) chooses from
    /// them.
    pub const DRAWN: &[Method] = DrawnMotion::METHODS;
}

// A plan computes each method for drawing in one of the two sizes.
const _: () = assert!(
    Motion32::METHODS.len() + 1 == Method::DRAWN.len(),
    "a method of DrawnMotion is missing in Motion32"
);

/// Generic code that [`Method::visit`] calls with the type of a method.
pub trait FormVisitor {
    /// The result of the call.
    type Output;

    /// Runs the code for the method that the type `F` computes.
    fn visit<F: Form>(self) -> Self::Output;
}

/// Writes [`Method::visit`].
macro_rules! visit {
    ($(
        $number:literal $method:ident = $name:literal, $equations:ident, $numbers:ident,
        $integrator:ident, $order:literal, $form:tt $(<$of:literal>)?;
    )*) => {
        impl Method {
            /// Calls `visitor` with the type that computes this method, and returns its result;
            /// `None`, without a call, for `rk4-f32-micromath` and `textbook-f32`, whose types are
            /// not in this crate.
            ///
            /// This links every method. To link one method only, pass its type to
            /// [`Pendulum::run`](crate::Pendulum::run).
            ///
            /// ```
            /// use double_pendulum::{Form, FormVisitor, Method, Parameters, Pendulum, State};
            ///
            /// /// Computes the angle of rod 1 after a second.
            /// struct AfterOneSecond;
            ///
            /// impl FormVisitor for AfterOneSecond {
            ///     type Output = Result<f64, double_pendulum::Error>;
            ///
            ///     fn visit<F: Form>(self) -> Self::Output {
            ///         let parameters = Parameters::equal_rods(1.0, 1.0, 9.81);
            ///         let pendulum = Pendulum::<f64>::new(&parameters)?;
            ///         let mut run = pendulum.run::<F>(&State::at_rest(0.5, 0.5), 1.0 / 128.0)?;
            ///         run.advance(128)?;
            ///         Ok(run.state().a1)
            ///     }
            /// }
            ///
            /// let method = Method::from_name("rk4-fixed32").ok_or("no such method")?;
            /// let angle = method.visit(AfterOneSecond).ok_or("not in this crate")??;
            /// assert!(angle.abs() < 0.5);
            /// # Ok::<(), Box<dyn std::error::Error>>(())
            /// ```
            pub fn visit<V: FormVisitor>(self, visitor: V) -> Option<V::Output> {
                match self {
                    $(Method::$method => visit!(@call visitor $form $(<$of>)?),)*
                }
            }
        }
    };
    (@call $visitor:ident -) => {
        None
    };
    (@call $visitor:ident $form:ty) => {
        Some($visitor.visit::<$form>())
    };
}

table!(visit);
