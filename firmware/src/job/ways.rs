//! The ways to compute a motion, one row of a table for each arithmetic, model and form that go together, and the job of
//! computing it by one of them.

use core::fmt;

use double_pendulum::Error;
use double_pendulum::form::{AngleForm, Compensated, DirectionForm, Plain};

use super::run::{Equal, Formed, General, Linear, Run, Wound};
use super::{Arithmetic, Formulation, Model, Reading, Request};
use crate::protocol::Field;

macro_rules! runs {
    ($($name:ident: $arithmetic:ident, $model:ident, $form:ident => $run:ty;)*) => {
        #[derive(Clone, Copy, Debug)]
        enum Kind { $($name($run),)* }

        impl Kind {
            fn start(request: &Request) -> Result<Self, JobError> {
                match (request.arithmetic, request.model, request.form) {
                    $((Arithmetic::$arithmetic, Model::$model, Formulation::$form) => {
                        Ok(Kind::$name(<$run>::start(request).map_err(JobError::Refused)?))
                    })*
                    (_, _, form) => Err(JobError::NoSuchForm(form)),
                }
            }

            fn step(&mut self) {
                match self { $(Kind::$name(run) => run.step(),)* }
            }

            fn reading(&self) -> Reading {
                match self { $(Kind::$name(run) => run.reading(),)* }
            }
        }

        const WAYS: &[(Arithmetic, Model, Formulation)] =
            &[$((Arithmetic::$arithmetic, Model::$model, Formulation::$form),)*];
    };
}

runs! {
    GeneralF32: F32, General, Canonical => General<f32>;
    GeneralF64: F64, General, Canonical => General<f64>;
    EqualRodsF32: F32, EqualRods, Canonical => Equal<f32>;
    EqualRodsF64: F64, EqualRods, Canonical => Equal<f64>;
    LinearF32: F32, Linear, Canonical => Linear<f32>;
    LinearF64: F64, Linear, Canonical => Linear<f64>;
    AngleF32Compensated: F32Compensated, General, Angle => Formed<f32, AngleForm<f32, Compensated<f32>>>;
    AngleF32: F32, General, Angle => Formed<f32, AngleForm<f32, Plain>>;
    AngleF64: F64, General, Angle => Formed<f64, AngleForm<f64, Plain>>;
    DirectionF32Compensated: F32Compensated, General, Direction => Wound<f32, DirectionForm<f32, Compensated<f32>>>;
    DirectionF32: F32, General, Direction => Wound<f32, DirectionForm<f32, Plain>>;
    DirectionF64: F64, General, Direction => Wound<f64, DirectionForm<f64, Plain>>;
}

/// Why a request cannot be computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JobError {
    /// There is no such form of the model in the arithmetic.
    NoSuchForm(Formulation),
    /// The kernel refuses a number.
    Refused(Error),
}

impl fmt::Display for JobError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            JobError::NoSuchForm(form) => write!(f, "no {} form of this model in this arithmetic", form.name()),
            JobError::Refused(error) => write!(f, "{error}"),
        }
    }
}

impl core::error::Error for JobError {}

impl From<JobError> for Field {
    fn from(error: JobError) -> Self {
        match error {
            JobError::NoSuchForm(_) => Field::Form,
            JobError::Refused(error) => error.into(),
        }
    }
}

/// A request being answered: computes the samples one after the other, a bounded amount of work at a time.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    kind: Kind,
    stride: u32,
    /// Samples still to come, the one at the start included.
    left: u32,
    /// Steps until the next of them.
    steps: u32,
}

impl Job {
    /// Every arithmetic, model and form that go together.
    pub const WAYS: &[(Arithmetic, Model, Formulation)] = WAYS;

    /// The form taken of a `model` in an `arithmetic` where none is asked for; `None` if there is none.
    pub fn default_form(arithmetic: Arithmetic, model: Model) -> Option<Formulation> {
        Self::WAYS.iter().find(|way| (way.0, way.1) == (arithmetic, model)).map(|way| way.2)
    }

    /// Refuses what does not go together, and parameters, angles, velocities and step sizes that the kernel refuses.
    pub fn new(request: &Request) -> Result<Self, JobError> {
        let kind = Kind::start(request)?;
        Ok(Self { kind, stride: request.stride, left: request.samples.saturating_add(1), steps: 0 })
    }

    /// Whether every sample has been given.
    pub fn is_finished(&self) -> bool {
        self.left == 0
    }

    /// Computes at most one step; the reading, when a sample is due.
    ///
    /// Ends with [`Error::Diverged`] instead of a reading that is not finite: every one given before it is.
    pub fn advance(&mut self) -> Result<Option<Reading>, Error> {
        if self.is_finished() {
            return Ok(None);
        }
        if self.steps > 0 {
            self.kind.step();
            self.steps -= 1;
        }
        if self.steps > 0 {
            return Ok(None);
        }
        self.left -= 1;
        self.steps = self.stride;
        self.kind.reading().finite().map(Some).inspect_err(|_| self.left = 0)
    }
}
