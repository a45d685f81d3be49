//! What the board lends the application to tell of itself.

use crate::job::{CRC, OnBoards, Run};
use crate::protocol::Identity;

/// Nothing, by default, as on a host.
#[derive(Clone, Copy, Debug)]
pub struct Instruments {
    /// Counts of the processor clock; may wrap.
    pub stopwatch: fn() -> u32,
    /// Makes this many steps with interrupts off, running their code from RAM (`true`) or from flash. Returns the processor
    /// cycles taken; 0 without a cycle counter, or if the code is not in that memory.
    pub timed: fn(&mut OnBoards, u32, bool) -> u32,
    pub image: fn() -> &'static [u8],
    pub identity: Identity,
}

impl Default for Instruments {
    fn default() -> Self {
        let timed = |motion: &mut OnBoards, steps, _| {
            motion.advance(steps);
            0
        };
        Self {
            stopwatch: || 0,
            timed,
            image: || &[],
            identity: Identity::default(),
        }
    }
}

impl Instruments {
    /// The answer to [`Command::Identify`](crate::protocol::Command::Identify).
    pub fn identity(&self) -> Identity {
        let image = (self.image)();
        Identity {
            image: CRC.checksum(image),
            image_bytes: image.len() as u32,
            ..self.identity
        }
    }
}
