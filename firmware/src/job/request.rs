//! What is asked for: a message of the protocol with its words understood.

use core::fmt;

use double_pendulum::{Integrator, Method, Motion, Parameters, Pendulum};
use heapless::Vec;

use crate::protocol::{Field, MAX_FIELDS, Message, Simulate, method_code, method_of};

/// A motion to compute.
///
/// As text it is the fields of its [`Simulate`] message, each byte as two hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    pub method: Method,
    pub parameters: Parameters<f64>,
    pub angles: [f64; 2],
    pub velocities: [f64; 2],
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
        let pendulum = Pendulum::<f64>::new(&self.parameters)
            .ok()
            .filter(|_| self.method.integrator() != Integrator::ClosedForm)?;
        pendulum.admissible_step(&pendulum.to_state(&Motion { a1, a2, w1, w2 })).ok()
    }

    pub fn message(&self, request: u16) -> Simulate {
        let Parameters { m1, m2, l1, l2, g } = self.parameters;
        Simulate {
            request,
            method: method_code(self.method),
            parameters: [m1, m2, l1, l2, g],
            angles: self.angles,
            velocities: self.velocities,
            dt: self.dt,
            stride: self.stride,
            samples: self.samples,
        }
    }

    /// What a message asks for; refuses a method that does not exist.
    pub fn from_message(message: &Simulate) -> Result<Self, Field> {
        let [m1, m2, l1, l2, g] = message.parameters;
        Ok(Self {
            method: method_of(message.method).ok_or(Field::Method)?,
            parameters: Parameters { m1, m2, l1, l2, g },
            angles: message.angles,
            velocities: message.velocities,
            dt: message.dt,
            stride: message.stride,
            samples: message.samples,
        })
    }

    pub fn parse(text: &str) -> Result<Self, Field> {
        let mut fields = Vec::<u8, MAX_FIELDS>::new();
        for digits in text.as_bytes().chunks(2) {
            let digits = core::str::from_utf8(digits).map_err(|_| Field::Message)?;
            let byte = u8::from_str_radix(digits, 16).map_err(|_| Field::Message)?;
            fields.push(byte).map_err(|_| Field::Message)?;
        }
        Self::from_message(&Simulate::read(&fields).ok_or(Field::Message)?)
    }
}

impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message(0).write(&mut [0; MAX_FIELDS]).iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}
