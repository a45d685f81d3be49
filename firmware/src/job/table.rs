//! The table of arithmetics: one row for each arithmetic, model, form, integrator and order that go together, and the type
//! that computes it. A new one is a row here and a type that [`Run`]s.
//!
//! The first block is what every board's application computes on request. The second is there to be compared with: it is
//! computed on the host and counted on the chips by the `measure` program, and takes no flash of an application.

use double_pendulum::form::{Direction, DirectionForm, ExtrapolatedForm, Fixed32Form, Fixed64Form, Plain};
use double_pendulum::trig::{Libm, Micromath};
use double_pendulum::{Pendulum, State};

use super::canonical::{Canonical, Equal};
use super::formed::Directions;
use super::linear::{Drawn, Linear};
use super::textbook::Textbook;
use super::{
    Arithmetic, Formulation, Integrator, JobError, Model, Reading, Request, Row, Run, Wanted, answer, counted,
};

macro_rules! row {
    ($arithmetic:ident $model:ident $form:ident $integrator:ident $order:literal) => {
        Row {
            arithmetic: Arithmetic::$arithmetic,
            model: Model::$model,
            form: Formulation::$form,
            integrator: Integrator::$integrator,
            order: $order,
        }
    };
}

macro_rules! table {
    (
        on_boards { $($name:ident: ($($key:tt)*) => $run:ty;)* }
        elsewhere { $(($($other_key:tt)*) => $other:ty;)* }
    ) => {
        /// The rows that every board's application computes, the default first.
        pub const ON_BOARDS: &[Row] = &[$(row!($($key)*)),*];

        /// Every row, those first.
        pub const ROWS: &[Row] = &[$(row!($($key)*),)* $(row!($($other_key)*)),*];

        /// A motion by any row of the first block.
        #[derive(Clone, Copy, Debug)]
        pub enum OnBoards { $(#[doc = concat!("`", stringify!($($key)*), "`")] $name($run),)* }

        impl Run for OnBoards {
            // Apart from what else is done with a request: compilers shuffle so large a value word by word.
            #[inline(never)]
            fn start(request: &Request) -> Result<Self, JobError> {
                match request.row {
                    $(row!($($key)*) => <$run>::start(request).map(Self::$name),)*
                    row => Err(no_such(row, ON_BOARDS)),
                }
            }

            // Never inlined: a board may have it twice, in flash and in memory.
            #[inline(never)]
            fn advance(&mut self, steps: u32) {
                match self { $(Self::$name(run) => run.advance(steps),)* }
            }

            fn state(&self) -> State<f64> {
                match self { $(Self::$name(run) => run.state(),)* }
            }

            fn directions(&self) -> Option<[Direction<f64>; 2]> {
                match self { $(Self::$name(run) => run.directions(),)* }
            }

            fn bits(&self, feed: impl FnMut(u64)) {
                match self { $(Self::$name(run) => run.bits(feed),)* }
            }
        }

        impl Request {
            /// Gives every reading to `each`, the one at the start first, until it refuses one.
            pub fn readings<E: From<JobError>>(&self, each: impl FnMut(&Reading) -> Result<(), E>) -> Result<(), E> {
                match self.row {
                    $(row!($($key)*) => answer::readings::<$run, E>(self, each),)*
                    $(row!($($other_key)*) => answer::readings::<$other, E>(self, each),)*
                    row => Err(no_such(row, ROWS).into()),
                }
            }

            /// CRC-32 of all that is carried at every sample but the one at the start, and of the last state: two runs
            /// are the same to the bit if theirs are equal.
            pub fn crc(&self) -> Result<u32, JobError> {
                match self.row {
                    $(row!($($key)*) => counted::crc::<$run>(self),)*
                    $(row!($($other_key)*) => counted::crc::<$other>(self),)*
                    row => Err(no_such(row, ROWS)),
                }
            }
        }
    };
}

#[rustfmt::skip]
table! {
    on_boards {
        F64:              (F64            General   Canonical Rk4 4) => Canonical<f64>;
        F32:              (F32            General   Canonical Rk4 4) => Canonical<f32>;
        F64EqualRods:     (F64            EqualRods Canonical Rk4 4) => Equal<f64>;
        F32EqualRods:     (F32            EqualRods Canonical Rk4 4) => Equal<f32>;
        F64Linear:        (F64            Linear    Canonical ClosedForm 0) => Linear<f64>;
        F32Linear:        (F32            Linear    Canonical ClosedForm 0) => Linear<f32>;
        F64Direction:     (F64            General   Direction Rk4 4) => Directions<f64, DirectionForm<f64, Plain>>;
        F32Direction:     (F32            General   Direction Rk4 4) => Directions<f32, DirectionForm<f32, Plain>>;
        Compensated:      (F32Compensated General   Direction Rk4 4) => Directions<f32, DirectionForm<f32>>;
        Fixed32:          (Fixed32        General   Direction Rk4 4) => Directions<f64, Fixed32Form>;
        Fixed64Order12:   (Fixed64        General   Direction Extrapolation 12) => Directions<f64, Fixed64Form<12>>;
        Fixed64Order6:    (Fixed64        General   Direction Extrapolation 6) => Directions<f64, Fixed64Form<6>>;
        Fixed64Order8:    (Fixed64        General   Direction Extrapolation 8) => Directions<f64, Fixed64Form<8>>;
        Fixed64Order16:   (Fixed64        General   Direction Extrapolation 16) => Directions<f64, Fixed64Form<16>>;
    }
    elsewhere {
        (F32Libm        General  Canonical        Rk4 4) => Canonical<f32, Pendulum<f32, Libm>>;
        (F64Libm        General  Canonical        Rk4 4) => Canonical<f64, Pendulum<f64, Libm>>;
        (F32Micromath   General  Canonical        Rk4 4) => Canonical<f32, Pendulum<f32, Micromath>>;
        (F32Libm        Textbook Canonical        Rk4 4) => Canonical<f32, Textbook<f32>>;
        (F64Libm        Textbook Canonical        Rk4 4) => Canonical<f64, Textbook<f64>>;
        (F64Compensated General  Direction        Extrapolation 12) => Directions<f64, ExtrapolatedForm<12>>;
        (F64Compensated General  Direction        Extrapolation 8) => Directions<f64, ExtrapolatedForm<8>>;
        (F64Compensated General  Direction        Extrapolation 16) => Directions<f64, ExtrapolatedForm<16>>;
        (F32            Linear   Direction        ClosedForm 0) => Drawn;
    }
}

/// The refusal of a row that is not among `rows`.
fn no_such(row: Row, rows: &[Row]) -> JobError {
    JobError::NoSuchRow(Wanted::from(row).first_of(rows).err().unwrap_or(crate::protocol::Field::Arithmetic))
}
