//! What a request says: as a message of the protocol, as text, and how long its step may be; and the bits that its steps come to.

use core::fmt;

use double_pendulum::{Integrator, Method, Motion, Parameters, Pendulum};
use heapless::Vec;

use super::{JobError, Run};
use crate::config::GRAVITY;
use crate::protocol::{CRC, MAX_FIELDS, Message, Request, Simulate};

impl Request {
    /// 10 s of a chaotic motion, 2,560 steps: what is compared on every core there is, boards or not.
    pub fn on_any_core(method: Method) -> Self {
        let parameters = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: GRAVITY };
        let (angles, velocities) = ([2.0; 2], [0.0; 2]);
        Self { method, parameters, angles, velocities, dt: 1.0 / 256.0, stride: 80, samples: 32 }
    }

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

impl Default for Request {
    fn default() -> Self {
        Self::on_any_core(Method::Rk4F64)
    }
}

/// CRC-32 of all that is carried at every sample but the one at the start, and of the last state.
pub(super) fn crc<R: Run>(request: &Request) -> Result<u32, JobError> {
    let mut run = R::start(request)?;
    let mut digest = CRC.digest();
    for _ in 0..request.samples {
        counted_steps(&mut run, request.stride);
        run.bits(|word| digest.update(&word.to_le_bytes()));
    }
    <[f64; 4]>::from(run.state()).iter().for_each(|number| digest.update(&number.to_le_bytes()));
    Ok(digest.finalize())
}

/// What the counter counts, from this function's first instruction to its return; it finds it by this name.
#[inline(never)]
fn counted_steps<R: Run>(run: &mut R, steps: u32) {
    let mut local = *run;
    local.advance(steps);
    *run = local;
}
