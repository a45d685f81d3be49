//! The type that runs each method.
//!
//! The first block is what every board's application computes on request. The second is computed on the host and counted on the
//! chips by the `measure` program, and takes no flash of an application.

use double_pendulum::parts::{Canonical, Dimensionless, Stepper};
use double_pendulum::trig::{Libm, Micromath};
use double_pendulum::{
    ClosedFormF64, DirectionF32, DirectionF32Plain, DirectionF64Plain, ExtrapolationF64, Fixed32, Fixed64, HamiltonF32,
    HamiltonF64, Method, Pendulum, State,
};

use super::drawn::Drawn;
use super::textbook::Textbook;
use super::{JobError, Reading, Request, Run, answer, counted};

macro_rules! table {
    (
        on_boards { $($method:ident: $run:ty;)* }
        elsewhere { $($other:ident: $other_run:ty;)* }
    ) => {
        /// The methods that every board's application links, the default first.
        pub const ON_BOARDS: &[Method] = &[$(Method::$method),*];

        #[derive(Clone, Copy, Debug)]
        pub enum OnBoards { $(#[doc = concat!("[`Method::", stringify!($method), "`]")] $method($run),)* }

        impl Run for OnBoards {
            // Apart from what else is done with a request: compilers shuffle so large a value word by word.
            #[inline(never)]
            fn start(request: &Request) -> Result<Self, JobError> {
                match request.method {
                    $(Method::$method => <$run>::start(request).map(Self::$method),)*
                    method => Err(JobError::NotOnBoards(method)),
                }
            }

            // Never inlined: a board may have it twice, in flash and in memory.
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

        impl Request {
            /// Gives every reading to `each`, the one at the start first, until it refuses one.
            pub fn readings<E: From<JobError>>(&self, each: impl FnMut(&Reading) -> Result<(), E>) -> Result<(), E> {
                match self.method {
                    $(Method::$method => answer::readings::<$run, E>(self, each),)*
                    $(Method::$other => answer::readings::<$other_run, E>(self, each),)*
                }
            }

            /// CRC-32 of all that is carried at every sample but the one at the start, and of the last state: two runs
            /// are bit-identical if theirs are equal.
            pub fn crc(&self) -> Result<u32, JobError> {
                match self.method {
                    $(Method::$method => counted::crc::<$run>(self),)*
                    $(Method::$other => counted::crc::<$other_run>(self),)*
                }
            }
        }
    };
}

table! {
    on_boards {
        Rk4F64: Stepper<HamiltonF64>;
        Rk4F32: Stepper<HamiltonF32>;
        Rk4F64EqualRods: Stepper<Canonical<f64, Dimensionless<f64>>>;
        Rk4F64Direction: Stepper<DirectionF64Plain>;
        Rk4F32Direction: Stepper<DirectionF32>;
        Rk4F32DirectionPlain: Stepper<DirectionF32Plain>;
        Rk4Fixed32: Stepper<Fixed32>;
        Extrapolation8Fixed64: Stepper<Fixed64<8>>;
        Extrapolation10Fixed64: Stepper<Fixed64<10>>;
        Extrapolation12Fixed64: Stepper<Fixed64<12>>;
        Extrapolation16Fixed64: Stepper<Fixed64<16>>;
        ClosedFormF64: Stepper<ClosedFormF64>;
    }
    elsewhere {
        ClosedFormF32: Drawn;
        Extrapolation12F64: Stepper<ExtrapolationF64<12>>;
        Extrapolation16F64: Stepper<ExtrapolationF64<16>>;
        Rk4F32Libm: Stepper<Canonical<f32, Pendulum<f32, Libm>>>;
        Rk4F32Micromath: Stepper<Canonical<f32, Pendulum<f32, Micromath>>>;
        TextbookF32: Stepper<Canonical<f32, Textbook<f32>>>;
        TextbookF64: Stepper<Canonical<f64, Textbook<f64>>>;
    }
}
