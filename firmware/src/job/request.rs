//! What is asked for, checked.

use double_pendulum::{Error, Motion, Parameter, Parameters, Pendulum};

use super::{Arithmetic, Form, Model};
use crate::choice::choice;
use crate::protocol::Simulate;

/// A motion to compute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// The numbers it is computed in.
    pub arithmetic: Arithmetic,
    /// The equations.
    pub model: Model,
    /// What is stepped.
    pub form: Form,
    /// Masses, lengths and gravity.
    pub parameters: Parameters<f64>,
    /// a1, a2 at the start, rad.
    pub angles: [f64; 2],
    /// w1, w2 at the start, rad/s.
    pub velocities: [f64; 2],
    /// Step size, s.
    pub step_size: f64,
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
        pendulum.admissible_step(&pendulum.state(&Motion { a1, a2, w1, w2 })).ok()
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
            step_size: self.step_size,
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
            form: Form::from_code(message.form).ok_or(Field::Form)?,
            parameters: Parameters { m1, m2, l1, l2, g },
            angles: message.angles,
            velocities: message.velocities,
            step_size: message.step_size,
            stride: message.stride,
            samples: message.samples,
        })
    }
}

choice! {
    /// What a request or a command can be wrong in.
    Field {
        /// The arithmetic.
        Arithmetic = 0, "arithmetic";
        /// The model.
        Model = 1, "model";
        /// Mass of bob 1.
        M1 = 2, "m1";
        /// Mass of bob 2.
        M2 = 3, "m2";
        /// Length of rod 1.
        L1 = 4, "l1";
        /// Length of rod 2.
        L2 = 5, "l2";
        /// Gravity.
        G = 6, "g";
        /// Angle of rod 1.
        A1 = 7, "a1";
        /// Angle of rod 2.
        A2 = 8, "a2";
        /// Velocity of rod 1.
        W1 = 9, "w1";
        /// Velocity of rod 2.
        W2 = 10, "w2";
        /// Step size.
        StepSize = 11, "step size";
        /// Mass ratio m2/m1: sets m2.
        MassRatio = 12, "mu";
        /// Both angles.
        Angle = 13, "angle";
        /// Simulated time per real time.
        Speed = 14, "speed";
        /// The field to set.
        Field = 15, "field";
        /// The unit of the value.
        Unit = 16, "unit";
        /// The scene.
        Scene = 17, "scene";
        /// The message itself: of no known kind, or not of that kind's length.
        Message = 18, "message";
        /// The form, or that there is none such of the model in the arithmetic.
        Form = 19, "form";
    }
}

impl From<Error> for Field {
    fn from(error: Error) -> Self {
        if let Error::Diverged { .. } = error {
            return Field::StepSize;
        }
        match error.parameter() {
            Parameter::M1 => Field::M1,
            Parameter::M2 | Parameter::Mu => Field::M2,
            Parameter::L1 => Field::L1,
            Parameter::L2 => Field::L2,
            Parameter::G => Field::G,
            Parameter::A1 => Field::A1,
            Parameter::A2 => Field::A2,
            // A momentum at the start is the velocity times masses and lengths.
            Parameter::W1 | Parameter::P1 => Field::W1,
            Parameter::W2 | Parameter::P2 => Field::W2,
            _ => Field::StepSize,
        }
    }
}
