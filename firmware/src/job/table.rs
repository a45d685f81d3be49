//! The table of the methods, and of the type that runs each method.
//!
//! The application of every board links the methods of the first block, to compute them on request.
//! The methods of the second block are computed on the host, and counted on the chips by the
//! `measure` program. They take no flash of an application.

use double_pendulum::golden::{Bits, Golden};
use double_pendulum::parts::Canonical;
use double_pendulum::{
    ClosedFormF32, ClosedFormF64, Direction, DirectionF32, DirectionF32Plain, Error,
    ExtrapolationF64, Fixed32, Fixed64, HamiltonF32, HamiltonF64, Method, Pendulum, Real, State,
};

use super::comparison::{Micromath, Textbook};
use super::run::start;
use super::{Reading, Request, Run, answer, crc};

macro_rules! table {
    (
        on_boards { $($method:ident: $form:ty;)* }
        elsewhere { $($other:ident: $other_form:ty;)* }
    ) => {
        /// The methods that every board's application links, the default first.
        pub const ON_BOARDS: &[Method] = &[$(Method::$method),*];

        /// A motion in progress, by one of the methods that every board links.
        #[derive(Clone, Copy, Debug)]
        pub enum OnBoards {
            $(#[doc = concat!("[`Method::", stringify!($method), "`]")] $method($form),)*
        }

        impl OnBoards {
            /// Returns the motion of a request at its start, or the kernel's error. Returns `None`
            /// if boards do not have the method.
            #[inline(never)] // Inlined, the compiler would move this large value word by word.
            pub fn start(request: &Request) -> Option<Result<Self, Error>> {
                Some(match request.method {
                    $(Method::$method => start::<$form>(request).map(Self::$method),)*
                    _ => return None,
                })
            }
        }

        impl Run for OnBoards {
            // Not inlined, because a board may have this function twice, in flash and in RAM.
            #[inline(never)]
            fn advance(&mut self, steps: u32) {
                match self { $(Self::$method(run) => Run::advance(run, steps),)* }
            }

            fn state(&self) -> State<f64> {
                match self { $(Self::$method(run) => Run::state(run),)* }
            }

            fn sides(&self) -> Option<[[i32; 2]; 2]> {
                match self { $(Self::$method(run) => Run::sides(run),)* }
            }

            fn bits(&self, feed: impl FnMut(u64)) {
                match self { $(Self::$method(run) => Run::bits(run, feed),)* }
            }
        }

        /// A [`Run`](double_pendulum::Run) whose method is chosen at run time.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum AnyRun {
            $($method(double_pendulum::Run<$form>),)*
            $($other(double_pendulum::Run<$other_form>),)*
        }

        /// Evaluates `$body`, where `$run` is the run of the method in `$any`.
        macro_rules! any {
            ($any:expr, $run:ident => $body:expr) => {
                match $any {
                    $(AnyRun::$method($run) => $body,)*
                    $(AnyRun::$other($run) => $body,)*
                }
            };
        }

        impl AnyRun {
            pub fn new(
                method: Method,
                pendulum: &Pendulum<f64>,
                start: &State<f64>,
                dt: f64,
            ) -> Result<Self, Error> {
                Ok(match method {
                    $(Method::$method => Self::$method(pendulum.run(start, dt)?),)*
                    $(Method::$other => Self::$other(pendulum.run(start, dt)?),)*
                })
            }

            pub fn advance(&mut self, steps: u32) -> Result<(), Error> {
                any!(self, run => run.advance(steps))
            }

            pub fn state(&self) -> State<f64> {
                any!(self, run => run.state())
            }

            pub fn directions(&self) -> [Direction<f64>; 2] {
                any!(self, run => run.directions().map(|direction| direction.map(Real::to_f64)))
            }

            pub fn angles(&self) -> [f64; 2] {
                any!(self, run => run.angles().map(Real::to_f64))
            }

            pub fn energy(&self) -> f64 {
                any!(self, run => run.energy().to_f64())
            }
        }

        /// Returns the bits of a motion of the kernel's golden file by a method.
        pub(super) fn golden_bits(method: Method, motion: &Golden) -> Result<Bits, Error> {
            match method {
                $(Method::$method => motion.bits::<$form>(),)*
                $(Method::$other => motion.bits::<$other_form>(),)*
            }
        }

        impl Request {
            /// Calls `each` with every reading, the initial one first, until it returns an error.
            pub fn readings<E: From<Error>>(
                &self,
                each: impl FnMut(&Reading) -> Result<(), E>,
            ) -> Result<(), E> {
                match self.method {
                    $(Method::$method => answer::readings(start::<$form>(self)?, self, each),)*
                    $(Method::$other => answer::readings(start::<$other_form>(self)?, self, each),)*
                }
            }

            /// Returns the CRC-32 of all numbers that the method carries, at every sample except
            /// the initial one, and of the last state. If those of two runs are equal, the runs are
            /// bit-identical.
            pub fn crc(&self) -> Result<u32, Error> {
                Ok(match self.method {
                    $(Method::$method => crc(start::<$form>(self)?, self),)*
                    $(Method::$other => crc(start::<$other_form>(self)?, self),)*
                })
            }
        }
    };
}

table! {
    on_boards {
        Rk4F64: HamiltonF64;
        Rk4F32: HamiltonF32;
        Rk4F32Direction: DirectionF32;
        Rk4F32DirectionPlain: DirectionF32Plain;
        Rk4Fixed32: Fixed32;
        Extrapolation8Fixed64: Fixed64<8>;
        Extrapolation10Fixed64: Fixed64<10>;
        Extrapolation12Fixed64: Fixed64<12>;
        Extrapolation16Fixed64: Fixed64<16>;
        ClosedFormF64: ClosedFormF64;
        ClosedFormF32: ClosedFormF32;
    }
    elsewhere {
        Extrapolation12F64: ExtrapolationF64<12>;
        Extrapolation16F64: ExtrapolationF64<16>;
        Rk4F32Micromath: Canonical<f32, Micromath>;
        TextbookF32: Canonical<f32, Textbook>;
    }
}
