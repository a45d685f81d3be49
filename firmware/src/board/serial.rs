//! Bytes over a board's serial port: an interrupt puts those received into a queue, from which the application takes them; each
//! one sent waits until the port takes it, but not without end.

use embedded_io::{ErrorKind, ErrorType, Write};
use heapless::Deque;

use super::cortex_m::interrupt::Shared;
use crate::config::{BUS_TRIES, RECEIVE_QUEUE};

/// The inward direction of a port.
#[derive(Clone, Copy)]
pub(in crate::board) struct Inward {
    /// Ends the receiver's interrupt, given for how many bytes there is room. Done before the bytes are taken, so that one that
    /// comes meanwhile interrupts anew.
    pub clear: fn(usize),
    pub take: fn() -> Taken,
}

pub(in crate::board) struct Taken {
    /// The next byte; `None` once there is none.
    pub byte: Option<u8>,
    /// Whether the port has had no room for a byte, or for several in a row, since it was last asked.
    pub overrun: bool,
}

struct Link {
    port: Option<Inward>,
    received: Deque<u8, RECEIVE_QUEUE>,
    lost: u32,
}

static LINK: Shared<Link> = Shared::new(Link { port: None, received: Deque::new(), lost: 0 });

/// Lets the interrupt fill the queue from this port.
pub(in crate::board) fn receive_from(port: Inward) -> Receiver {
    LINK.with(|link| link.port = Some(port));
    Receiver(())
}

/// Moves what has come into the queue; for the receiver's interrupt.
pub(in crate::board) fn receive() {
    LINK.with(|Link { port, received, lost }| {
        let Some(Inward { clear, take }) = *port else { return };
        clear(received.capacity().saturating_sub(received.len()));
        loop {
            let Taken { byte, overrun } = take();
            let is_refused = byte.is_some_and(|byte| received.push_back(byte).is_err());
            *lost = lost.wrapping_add(u32::from(overrun) + u32::from(is_refused));
            if byte.is_none() {
                break;
            }
        }
    });
}

/// The application's end of the queue.
pub struct Receiver(());

impl Receiver {
    /// A lower bound on the bytes that have overrun the port or the queue since reset: a port may report several at once. Wraps.
    pub fn lost(&self) -> u32 {
        LINK.with(|link| link.lost).unwrap_or_default()
    }
}

impl Iterator for Receiver {
    type Item = u8;

    fn next(&mut self) -> Option<u8> {
        LINK.with(|link| link.received.pop_front()).flatten()
    }
}

/// The outward direction of a port.
pub struct Transmitter {
    /// Whether it takes a byte to be sent now.
    pub(in crate::board) is_ready: fn() -> bool,
    /// Gives it a byte to be sent, once it is ready.
    pub(in crate::board) put: fn(u8),
}

impl ErrorType for Transmitter {
    type Error = ErrorKind;
}

impl Write for Transmitter {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        for &byte in bytes {
            if !(0..BUS_TRIES).any(|_| (self.is_ready)()) {
                return Err(ErrorKind::TimedOut);
            }
            (self.put)(byte);
        }
        Ok(bytes.len())
    }

    /// Bytes leave by themselves; there is nothing to wait for.
    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
