//! The bytes of a board's serial port: 8 data bits, no parity and 1 stop bit, at
//! [`BAUD`](crate::config::BAUD).
//!
//! An interrupt puts received bytes into a queue, and the application takes them from it. Bytes to
//! send wait until the port takes them, but not without a limit.

use embedded_io::{ErrorKind, ErrorType, Write};
use heapless::Deque;

use super::cortex_m::interrupt::Shared;
use crate::config::{BUS_TRIES, RECEIVE_QUEUE};

/// The received bytes that are not taken yet, and the function that receives.
pub(in crate::board) struct Inbox {
    receive: Option<fn(&mut Inbox)>,
    /// The queue, the oldest byte first.
    pub received: Deque<u8, RECEIVE_QUEUE>,
    /// The number of bytes that are lost; see [`lost`].
    lost: u32,
}

static INBOX: Shared<Inbox> = Shared::new(Inbox {
    receive: None,
    received: Deque::new(),
    lost: 0,
});

impl Inbox {
    /// Puts a received byte into the queue. If the queue is full, the byte is lost and counted.
    pub fn push(&mut self, byte: u8) {
        let is_refused = self.received.push_back(byte).is_err();
        self.note_overrun(is_refused);
    }

    /// Counts one lost byte if `overrun` is true: the port had no room for a byte, or for several
    /// in a row. Otherwise does nothing.
    pub fn note_overrun(&mut self, overrun: bool) {
        self.lost = self.lost.wrapping_add(overrun.into());
    }
}

/// Sets the function that receives. It must end the port's interrupt before it takes the bytes, so
/// that a byte that comes meanwhile interrupts again. A later call replaces it. The interrupt must
/// be unmasked separately.
pub(in crate::board) fn receive_by(receive: fn(&mut Inbox)) {
    INBOX.with(|inbox| inbox.receive = Some(receive));
}

/// Receives bytes; called by the receiver's interrupt. Does nothing before [`receive_by`].
pub(in crate::board) fn receive() {
    INBOX.with(|inbox| inbox.receive.map(|receive| receive(inbox)));
}

/// Takes the oldest received byte from the queue; `None` if the queue is empty. Does not wait. On
/// the Pico the bytes of USB and of the UART are in this one queue, as they come.
pub fn received() -> Option<u8> {
    INBOX.with(|inbox| inbox.received.pop_front()).flatten()
}

/// Returns a lower bound of the number of bytes that were lost since reset because the port or the
/// queue was full; wraps. It is a lower bound because a port may report several bytes at once.
pub fn lost() -> u32 {
    INBOX.with(|inbox| inbox.lost).unwrap_or_default()
}

/// The sending direction of a port. The function sends bytes, and returns true if the port has
/// taken all of them in time.
///
/// [`Write::write`] waits for that. It returns the number of all bytes, 0 for none, or
/// [`ErrorKind::TimedOut`] if the port was late; a part of the bytes may then have been sent. The
/// port is late after [`BUS_TRIES`] polls for a byte. [`Write::flush`] does nothing.
///
/// On the Pico the result is that of the UART. It is late after four times [`BUS_TRIES`] tries for
/// the whole message, at least 8 ms, and has then sent no part; a message longer than
/// [`UART_QUEUE`](crate::config::UART_QUEUE) always is. USB gets the message before, or drops it
/// without an error.
pub struct Outward(pub(in crate::board) fn(&[u8]) -> bool);

/// Sends bytes one by one. Each waits until the port `is_ready` for it, at most [`BUS_TRIES`]
/// polls. Returns true if all are sent. Otherwise the bytes from the first late one on are not
/// sent.
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
