//! The I2C bus of a panel: the outbox of messages, and the recovery of a bus that hangs.
//!
//! The outbox is filled while the bus is idle. The bus's interrupt sends it while the next frame is
//! computed.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use heapless::Vec;

use crate::graphics::{Format, PAGES};

const WIDTH: usize = Format::OLED.width as usize;

/// The capacity for a whole frame, with the window and the bytes of each page, and for all commands
/// that set a panel up.
const CAPACITY: usize = PAGES * (5 + 2 + WIDTH) + 48;

/// The largest number of bytes that are read from a panel at once.
const ANSWER: usize = 2;

/// Messages to one address, and the answer to them. Each message is stored as its length and its
/// bytes.
#[derive(Debug)]
pub struct Outbox {
    pub address: u8,
    messages: Vec<u8, CAPACITY>,
    at: usize,
    left: u8,
    asked: u8,
    /// The number of these bytes that have been requested, on a bus that needs a request for each
    /// byte.
    pub requested: usize,
    answer: Vec<u8, ANSWER>,
    /// `None` while the messages are being sent, `Ok` while nothing has been sent.
    pub sent: Option<Sent>,
}

/// The outcome of the messages in an outbox. [`ErrorKind::NoAcknowledge`] means that the panel is
/// silent, [`ErrorKind::ArbitrationLoss`] that another device drove the bus, and any other error
/// that the transfer was aborted or hangs.
pub type Sent = Result<(), ErrorKind>;

/// The error of a panel that does not acknowledge.
pub const SILENCE: ErrorKind = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutByte {
    pub value: u8,
    /// A stop follows or, if the bus prefers it, the start of the next message or of the answer.
    pub ends_message: bool,
}

impl Default for Outbox {
    fn default() -> Self {
        Self {
            address: 0,
            messages: Vec::new(),
            at: 0,
            left: 0,
            asked: 0,
            requested: 0,
            answer: Vec::new(),
            sent: Some(Ok(())),
        }
    }
}

impl Outbox {
    /// Empties the outbox. Messages put in from now on are for this address.
    pub fn address_to(&mut self, address: u8) {
        self.address = address;
        self.messages.clear();
        self.at = 0;
        self.left = 0;
        self.asked = 0;
        self.requested = 0;
        self.answer.clear();
        self.sent = Some(Ok(()));
    }

    /// Appends a message: the control byte `head`, and up to 254 bytes. The longest update of a
    /// panel fits (test `oled_i2c`).
    pub fn put(&mut self, head: u8, body: &[u8]) {
        let needed = 2 + body.len();
        if let Ok(length) = u8::try_from(needed - 1)
            && self.messages.len() + needed <= CAPACITY
        {
            let parts: [&[u8]; 2] = [&[length, head], body];
            parts
                .iter()
                .for_each(|part| drop(self.messages.extend_from_slice(part)));
        }
    }

    /// Requests that this many bytes, at most 2, are read from the panel after the messages.
    pub fn ask(&mut self, bytes: u8) {
        self.asked = bytes.min(ANSWER as u8);
    }

    pub fn asked(&self) -> usize {
        self.asked.into()
    }

    /// Takes a byte that was read.
    pub fn answer(&mut self, byte: u8) {
        // A byte beyond the capacity is dropped.
        let _ = self.answer.push(byte);
    }

    /// Returns the bytes that were read.
    pub fn answered(&self) -> &[u8] {
        &self.answer
    }

    /// Returns true if all messages are sent. An answer may be outstanding.
    pub fn is_empty(&self) -> bool {
        self.at == self.messages.len()
    }

    /// Returns true in the middle of a message.
    pub fn is_within_message(&self) -> bool {
        self.left != 0
    }
}

impl Iterator for Outbox {
    type Item = OutByte;

    fn next(&mut self) -> Option<OutByte> {
        if self.left == 0 {
            self.left = *self.messages.get(self.at)?;
            self.at += 1;
        }

        let value = *self.messages.get(self.at)?;
        self.at += 1;
        self.left -= 1;
        Some(OutByte {
            value,
            ends_message: self.left == 0,
        })
    }
}

/// A bus that sends an outbox while the processor does other work.
pub trait PanelBus {
    /// Returns the outbox, and the outcome of its last messages; `None` while they are being sent.
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)>;

    /// Begins to send the messages in the outbox, of which there must be one, because an empty
    /// transfer may never end.
    fn send(&mut self);

    /// Aborts the transfer, and frees a bus that hangs, as far as that is possible. The outbox is
    /// then available, with the outcome [`ErrorKind::Other`].
    fn abort(&mut self);
}

/// The largest number of clocks that a panel can be waiting for: the eight bits of a byte and its
/// acknowledgement.
const MOST_CLOCKS: u32 = 9;

/// Frees a bus whose data line a panel holds low: clocks the bus until the data line is high, at
/// most nine times, and then makes a stop. Returns true if the line is high in the end.
///
/// A panel can be left in the middle of an answer, if the board is reset in the middle of a byte,
/// or if the panel is plugged in while the bus is running. It holds the data line low for a bit
/// that is never fetched, so that no start is possible.
///
/// `drive` releases the clock line and the data line (`true`) or pulls them low, in this order, and
/// waits for half a clock. Then it returns true if the data line is high.
///
/// Source: NXP UM10204, I2C-bus specification, 3.1.16 (bus clear).
pub fn free_bus(mut drive: impl FnMut(bool, bool) -> bool) -> bool {
    if drive(true, true) {
        return true;
    }

    for _ in 0..MOST_CLOCKS {
        drive(false, true);
        if drive(true, true) {
            break;
        }
    }

    // Make a stop: the data line rises while the clock is high.
    drive(false, false);
    drive(true, false);
    drive(true, true)
}
