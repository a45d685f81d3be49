//! What the board lends the application to tell of itself.

use crate::protocol::{CRC, Identity};

/// Nothing, by default, as on a host.
#[derive(Clone, Copy, Debug)]
pub struct Instruments {
    /// Counts of the processor clock; may wrap.
    pub stopwatch: fn() -> u32,
    /// Does something with interrupts off: processor cycles that it took, 0 where nothing counts them.
    pub timed: fn(&mut dyn FnMut()) -> u32,
    /// The program in flash.
    pub image: fn() -> &'static [u8],
    /// The board and its chip.
    pub identity: Identity,
}

impl Default for Instruments {
    fn default() -> Self {
        let timed = |work: &mut dyn FnMut()| {
            work();
            0
        };
        Self { stopwatch: || 0, timed, image: || &[], identity: Identity::default() }
    }
}

impl Instruments {
    /// The answer to [`Command::Identify`](crate::app::command::Command::Identify).
    pub fn identity(&self, request: u16) -> Identity {
        let image = (self.image)();
        Identity { request, image: CRC.checksum(image), image_bytes: image.len() as u32, ..self.identity }
    }
}
