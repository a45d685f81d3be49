//! The steps that are counted, and what the bits come to after them.

use super::{JobError, Request, Run};
use crate::protocol::CRC;

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
