//! Bytes over a board's serial port: an interrupt puts those received into a queue, from which the application takes them; those
//! sent wait until the port takes them, but not without end.

use embedded_io::{ErrorKind, ErrorType, Write};
use heapless::Deque;

use super::cortex_m::interrupt::Shared;
use crate::config::{BUS_TRIES, RECEIVE_QUEUE};

/// What has come and is not taken yet, and how the interrupt receives.
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

    /// Whether the port has had no room for a byte, or for several in a row.
    pub fn note_overrun(&mut self, overrun: bool) {
        self.lost = self.lost.wrapping_add(overrun.into());
    }
}

/// How the interrupt receives. A port's interrupt is ended before its bytes are taken, so that one that comes meanwhile
/// interrupts anew.
pub(in crate::board) fn receive_by(receive: fn(&mut Inbox)) {
    INBOX.with(|inbox| inbox.receive = Some(receive));
}

/// For the receiver's interrupt.
pub(in crate::board) fn receive() {
    INBOX.with(|inbox| inbox.receive.map(|receive| receive(inbox)));
}

/// The application's end of the queue.
pub fn received() -> Option<u8> {
    INBOX.with(|inbox| inbox.received.pop_front()).flatten()
}

/// A lower bound on the bytes that have overrun the port or the queue since reset: a port may report several at once. Wraps.
pub fn lost() -> u32 {
    INBOX.with(|inbox| inbox.lost).unwrap_or_default()
}

/// The outward direction of a port: sends bytes; whether it has taken them in time.
pub struct Outward(pub(in crate::board) fn(&[u8]) -> bool);

/// Sends bytes one by one: each waits until the port `is_ready` for it.
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

    /// Bytes leave by themselves; there is nothing to wait for.
    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
