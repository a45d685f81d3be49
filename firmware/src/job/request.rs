//! A request, as text too, how long its step may be, and what is told of its motion; and the bits that its steps come to.

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc, Table};
use double_pendulum::{Integrator, Method, Motion, Parameters, Pendulum};
use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::{JobError, Run};
use crate::config::GRAVITY;

/// The reflected CRC-32 of zip and Ethernet.
pub const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// The most bytes that a request takes in postcard's format.
const MAX_BYTES: usize = 1 + 10 * 8 + 2 * 5;

/// A motion to compute, by a method that the chip's application has or not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub struct Request {
    pub method: Method,
    /// m1, m2 (kg), l1, l2 (m), g (m/s^2), in this order.
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

/// What is told of a motion asked for. The state is widened, which loses nothing, and of the fast forms given to the last digit
/// they carry; what follows from it is computed in double precision.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// a1, a2 (rad), p1, p2 (kg m^2/s).
    pub state: [f64; 4],
    /// w1, w2, rad/s.
    pub velocities: [f64; 2],
    /// Energy, J; zero potential at the pivot.
    pub energy: f64,
}

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

    /// From its bytes in postcard's format, each as two hexadecimal digits.
    pub fn parse(text: &str) -> Result<Self, JobError> {
        let mut bytes = Vec::<u8, MAX_BYTES>::new();
        let byte = |digits: &[u8]| u8::from_str_radix(core::str::from_utf8(digits).ok()?, 16).ok();
        let is_read = text.as_bytes().chunks(2).all(|digits| byte(digits).is_some_and(|byte| bytes.push(byte).is_ok()));
        let request = is_read.then(|| postcard::take_from_bytes(&bytes).ok()).flatten();
        request.filter(|(_, rest)| rest.is_empty()).map(|(request, _)| request).ok_or(JobError::Malformed)
    }
}

/// As [`Request::parse`] reads it.
impl fmt::Display for Request {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = &mut [0; MAX_BYTES];
        let bytes = postcard::to_slice(self, bytes).map_err(|_| fmt::Error)?;
        bytes.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
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
