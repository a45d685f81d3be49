//! The measuring functions that a board provides to the application.

use double_pendulum::parts::Advance;

use crate::job::{BoardMotion, CRC};
use crate::protocol::Identity;

/// The measuring functions and the identity of a board. The default, as on a host, measures
/// nothing.
#[derive(Clone, Copy, Debug)]
pub struct Instruments {
    /// Returns the count of the processor clock, for differences; starts anywhere and wraps. The
    /// default always returns 0.
    pub stopwatch: fn() -> u32,
    /// Makes this number of steps of a motion with interrupts off. Returns the processor cycles
    /// taken, on a Cortex-M0+ modulo 2^24; 0 without a cycle counter, as by default.
    pub timed: fn(&mut BoardMotion, u32) -> u32,
    /// Returns the bytes of the program in flash; none by default.
    pub image: fn() -> &'static [u8],
    /// The identity. The checksum and the size of the image in it are not used;
    /// [`identity()`](Self::identity()) computes them.
    pub identity: Identity,
}

impl Default for Instruments {
    fn default() -> Self {
        let timed = |motion: &mut BoardMotion, steps| {
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
    /// Returns the answer to [`Command::Identify`](crate::protocol::Command::Identify): `identity`
    /// with the CRC-32/ISO-HDLC of the image and its size, bytes. Both are 0 if the image is empty.
    /// Each call reads the whole image.
    pub fn identity(&self) -> Identity {
        let image = (self.image)();
        Identity {
            image: CRC.checksum(image),
            image_bytes: image.len() as u32,
            ..self.identity
        }
    }
}
