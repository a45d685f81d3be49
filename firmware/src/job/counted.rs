//! The steps that are counted, and what the bits come to after them.

use double_pendulum::{Method, Parameters};

use super::{JobError, Request, Run};
use crate::config::GRAVITY;
use crate::protocol::CRC;

impl Request {
    /// 10 s of a chaotic motion, 2,560 steps: what is compared on every core there is, boards or not.
    pub fn on_any_core(method: Method) -> Self {
        let parameters = Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: 1.0, g: GRAVITY };
        let (angles, velocities) = ([2.0; 2], [0.0; 2]);
        Self { method, parameters, angles, velocities, dt: 1.0 / 256.0, stride: 80, samples: 32 }
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
