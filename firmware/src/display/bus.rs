//! A panel's I2C bus: the messages on their way, filled in while it stands still and sent by its interrupt while the next frame is
//! computed; and how it is freed.

use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use heapless::Vec;

use crate::graphics::{PAGES, WIDTH};

/// A whole frame, of each page its window and its bytes, and all that wakes a panel.
const CAPACITY: usize = PAGES * (5 + 2 + WIDTH) + 48;

/// Most bytes that are read from a panel at once.
const ANSWER: usize = 2;

/// Messages to one address, each as its length and its bytes, and the answer to them.
#[derive(Debug)]
pub struct Outbox {
    /// The address of the panel, set by [`address_to`](Self::address_to).
    pub address: u8,
    messages: Vec<u8, CAPACITY>,
    /// The index of the next byte to send.
    at: usize,
    /// Bytes left of the message that is being sent.
    left: u8,
    /// Bytes to read from the panel after the messages.
    asked: u8,
    /// Bytes of these that the bus has been told to read, where it is told of each.
    pub requested: usize,
    /// The bytes read.
    answer: Vec<u8, ANSWER>,
    /// The outcome; `None` while the messages are being sent.
    pub sent: Option<Sent>,
    /// The time that the messages took, us; 0 if it is not known.
    pub took: u32,
}

pub type Sent = Result<(), ErrorKind>;

/// No panel acknowledges.
pub const SILENCE: ErrorKind = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutByte {
    pub value: u8,
    /// The byte is the last of its message: a stop follows, or the start of the next message.
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
            took: 0,
        }
    }
}

impl Outbox {
    /// Empties the outbox; messages put in from now on are for this address.
    pub fn address_to(&mut self, address: u8) {
        self.address = address;
        self.messages.clear();
        self.at = 0;
        self.left = 0;
        self.asked = 0;
        self.requested = 0;
        self.answer.clear();
        self.sent = Some(Ok(()));
        self.took = 0;
    }

    /// Appends a message: a byte that says what follows, and up to 254 bytes. A message that does
    /// not fit is dropped; the longest update of a panel fits (test `oled_i2c`).
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

    /// Reads this many bytes, at most 2, from the panel after the messages.
    pub fn ask(&mut self, bytes: u8) {
        self.asked = bytes.min(ANSWER as u8);
    }

    /// Returns the number of bytes to read.
    pub fn asked(&self) -> usize {
        self.asked.into()
    }

    /// Takes a byte that was read.
    pub fn answer(&mut self, byte: u8) {
        // A byte that was not asked for is dropped.
        let _ = self.answer.push(byte);
    }

    /// Returns the bytes read: as many as were asked for once the messages are sent.
    pub fn answered(&self) -> &[u8] {
        &self.answer
    }

    /// Returns the bytes on the bus: those of the messages and of the answer, with an address for
    /// each.
    pub fn len(&self) -> usize {
        let read = if self.asked == 0 { 0 } else { 1 + self.asked() };
        self.messages.len() + read
    }

    /// Returns true when all messages are sent; an answer may be outstanding.
    pub fn is_empty(&self) -> bool {
        self.at == self.messages.len()
    }

    /// Returns true if a message is being sent and its last byte is still to come.
    pub fn is_within_message(&self) -> bool {
        self.left != 0
    }
}

impl Iterator for Outbox {
    type Item = OutByte;

    /// Returns the next byte to send; messages follow each other in their order.
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

/// A bus that empties an outbox while the processor does something else.
pub trait PanelBus {
    /// The outbox, and what has become of the messages put in last; `None` as long as they are going out.
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)>;

    /// Sends what is in the outbox; returns at once.
    fn send(&mut self);

    /// Aborts the transfer, which then has failed, and frees a bus that hangs.
    fn abort(&mut self);
}

/// The most clocks that a panel can be waiting for: the eight bits of a byte and its acknowledgement.
const MOST_CLOCKS: u32 = 9;

/// Frees a bus whose data line a panel holds low: clocks it until that line is high, at most nine times, then makes a stop. A bus
/// whose data line is high already is left alone. Whether the line is high in the end: if not, the panel is defective, or the line is
/// short of a resistor.
///
/// A board that is reset in the middle of a byte, or a panel plugged in while the bus runs, leaves the panel in the middle of
/// an answer: it holds the line for a bit that is never fetched, and no start can be made.
///
/// `drive` lets the clock and the data line go (`true`) or pulls them low, in this order, lets half a clock pass, and says whether
/// the data line is high then.
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
    // A stop: the data line rises while the clock is high.
    drive(false, false);
    drive(true, false);
    drive(true, true)
}
