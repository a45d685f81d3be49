//! What a request says: as a message of the protocol, as text, and how long its step may be.

use core::fmt;

use double_pendulum::{Integrator, Motion, Pendulum};
use heapless::Vec;

use super::JobError;
use crate::protocol::{MAX_FIELDS, Message, Request, Simulate};

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
        Simulate { request, motion: *self }
    }

    /// From the fields of its message, each byte as two hexadecimal digits.
    pub fn parse(text: &str) -> Result<Self, JobError> {
        let mut fields = Vec::<u8, MAX_FIELDS>::new();
        let byte = |digits: &[u8]| u8::from_str_radix(core::str::from_utf8(digits).ok()?, 16).ok();
        let is_read =
            text.as_bytes().chunks(2).all(|digits| byte(digits).is_some_and(|byte| fields.push(byte).is_ok()));
        let message = is_read.then(|| Simulate::read(&fields)).flatten();
        message.map(|message| message.motion).ok_or(JobError::Malformed)
    }
}

/// As [`Request::parse`] reads it.
impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.message(0).write(&mut [0; MAX_FIELDS]).iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}
