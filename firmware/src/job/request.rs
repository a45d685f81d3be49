//! What is asked for, checked.

use double_pendulum::{Motion, Parameters, Pendulum};

use super::{Arithmetic, Formulation, Model};
use crate::protocol::{Field, Simulate};

/// A motion to compute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// The numbers it is computed in.
    pub arithmetic: Arithmetic,
    /// The equations.
    pub model: Model,
    /// What is stepped.
    pub form: Formulation,
    /// Masses, lengths and gravity.
    pub parameters: Parameters<f64>,
    /// a1, a2 at the start, rad.
    pub angles: [f64; 2],
    /// w1, w2 at the start, rad/s.
    pub velocities: [f64; 2],
    /// Step size, s.
    pub dt: f64,
    /// Steps from one sample to the next.
    pub stride: u32,
    /// Samples after the one at the start.
    pub samples: u32,
}

impl Request {
    /// The longest step, s, that resolves every motion of this energy: [`Pendulum::admissible_step`]. None for the closed
    /// form, which takes any, and for what [`Job::new`](super::Job::new) refuses.
    pub fn admissible_step(&self) -> Option<f64> {
        let ([a1, a2], [w1, w2]) = (self.angles, self.velocities);
        let pendulum = Pendulum::<f64>::new(self.parameters).ok().filter(|_| self.model != Model::Linear)?;
        pendulum.admissible_step(&pendulum.to_state(&Motion { a1, a2, w1, w2 })).ok()
    }

    /// The message that carries it.
    pub fn message(&self, request: u16) -> Simulate {
        let Parameters { m1, m2, l1, l2, g } = self.parameters;
        Simulate {
            request,
            arithmetic: self.arithmetic.code(),
            model: self.model.code(),
            form: self.form.code(),
            parameters: [m1, m2, l1, l2, g],
            angles: self.angles,
            velocities: self.velocities,
            dt: self.dt,
            stride: self.stride,
            samples: self.samples,
        }
    }

    /// What a message asks for; refuses an arithmetic, a model or a form that does not exist.
    pub fn from_message(message: &Simulate) -> Result<Self, Field> {
        let [m1, m2, l1, l2, g] = message.parameters;
        Ok(Self {
            arithmetic: Arithmetic::from_code(message.arithmetic).ok_or(Field::Arithmetic)?,
            model: Model::from_code(message.model).ok_or(Field::Model)?,
            form: Formulation::from_code(message.form).ok_or(Field::Form)?,
            parameters: Parameters { m1, m2, l1, l2, g },
            angles: message.angles,
            velocities: message.velocities,
            dt: message.dt,
            stride: message.stride,
            samples: message.samples,
        })
    }
}
