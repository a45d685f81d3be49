//! The bytes of a board's serial port: 8 data bits, no parity and 1 stop bit, at
//! [`BAUD`](crate::config::BAUD).
//!
//! An interrupt puts received bytes into a queue, and the application takes them from it. Bytes to
//! send wait until the port takes them, but not without a limit.

use embedded_io::{ErrorKind, ErrorType, Write};
use heapless::Deque;

use super::cortex_m::interrupt::Shared;
use crate::config::{BUS_TRIES, RECEIVE_QUEUE};

pub(in crate::board) struct Inbox {
    receive: Option<fn(&mut Inbox)>,
    pub received: Deque<u8, RECEIVE_QUEUE>,
    lost: u32,
}

static INBOX: Shared<Inbox> = Shared::new(Inbox {
    receive: None,
    received: Deque::new(),
    lost: 0,
});

impl Inbox {
    pub fn push(&mut self, byte: u8) {
        let is_refused = self.received.push_back(byte).is_err();
        self.note_overrun(is_refused);
    }

    pub fn note_overrun(&mut self, overrun: bool) {
        self.lost = self.lost.wrapping_add(overrun.into());
    }
}

/// Sets the function that receives. It must end the port's interrupt before it takes the bytes, so
/// that a byte that comes meanwhile interrupts again.
pub(in crate::board) fn receive_by(receive: fn(&mut Inbox)) {
    INBOX.with(|inbox| inbox.receive = Some(receive));
}

pub(in crate::board) fn receive() {
    INBOX.with(|inbox| inbox.receive.map(|receive| receive(inbox)));
}

/// Takes the oldest received byte. On the Pico the bytes of USB and of the UART are in this one
/// queue.
pub fn received() -> Option<u8> {
    INBOX.with(|inbox| inbox.received.pop_front()).flatten()
}

/// A lower bound of the bytes that were lost since reset; a port may report several bytes at once.
pub fn lost() -> u32 {
    INBOX.with(|inbox| inbox.lost).unwrap_or_default()
}

/// The sending direction of a port. The function sends bytes, and returns true if the port has
/// taken all of them in time.
///
/// On the Pico the result is that of the UART. USB gets the message before, or drops it.
pub struct Outward(pub(in crate::board) fn(&[u8]) -> bool);

/// Sends bytes one by one. Each waits until the port `is_ready` for it, at most [`BUS_TRIES`]
/// polls.
pub(in crate::board) fn send(bytes: &[u8], is_ready: impl Fn() -> bool, put: impl Fn(u8)) -> bool {
    bytes.iter().all(|&byte| {
        let is_ready = (0..BUS_TRIES).any(|_| is_ready());
        if is_ready {
            put(byte);
        }
        is_ready
    })
}

impl ErrorType for Outward {
    type Error = ErrorKind;
}

impl Write for Outward {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        if (self.0)(bytes) {
            Ok(bytes.len())
        } else {
            Err(ErrorKind::TimedOut)
        }
    }

    /// Returns at once, because the port sends the bytes on its own.
    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
