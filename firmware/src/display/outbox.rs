//! Messages on their way to a panel: filled while its bus stands still, emptied by the bus's interrupt while the next frame
//! is computed.

use embedded_hal::i2c::ErrorKind;
use heapless::Vec;

use crate::graphics::{PAGES, WIDTH};

/// A whole frame, of each page its window and its bytes, and all that wakes a panel.
const CAPACITY: usize = PAGES * (5 + 2 + WIDTH) + 48;

/// Messages to one address, each as its length and its bytes.
#[derive(Debug, Default)]
pub struct Outbox {
    /// Whom the messages are for, set by [`address_to`](Self::address_to).
    pub address: u8,
    messages: Vec<u8, CAPACITY>,
    /// The place of what goes out next.
    at: usize,
    /// Bytes that are left of the message which is going out.
    left: u8,
    /// Whether to read the panel's status byte after the messages.
    pub asks: bool,
    /// The status byte last read.
    pub status: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutByte {
    pub value: u8,
    /// Whether it is the last of its message: a stop follows, or the start of the next message.
    pub ends_message: bool,
}

impl Outbox {
    pub const fn new() -> Self {
        Self { address: 0, messages: Vec::new(), at: 0, left: 0, asks: false, status: 0 }
    }

    /// Empties it: what is put in from now on is for this address.
    pub fn address_to(&mut self, address: u8) {
        *self = Self { address, ..Self::new() };
    }

    /// Puts a message in: a byte that tells what follows, and what follows, up to 254 bytes. One that does not fit is dropped; the
    /// longest update of a panel fits (test `ssd1306`).
    pub fn put(&mut self, head: u8, body: &[u8]) {
        let needed = 2 + body.len();
        if let Ok(length) = u8::try_from(needed - 1)
            && self.messages.len() + needed <= CAPACITY
        {
            let parts: [&[u8]; 2] = [&[length, head], body];
            parts.iter().for_each(|part| drop(self.messages.extend_from_slice(part)));
        }
    }

    /// Bytes of the messages in it, their addresses included.
    pub fn len(&self) -> usize {
        self.messages.len()
    }

    pub fn is_empty(&self) -> bool {
        self.at == self.messages.len()
    }

    /// Whether anything has gone out; if not, what failed was the address.
    pub fn has_begun(&self) -> bool {
        self.at != 0
    }

    /// Whether a message goes out, its last byte still to come.
    pub fn is_within_message(&self) -> bool {
        self.left != 0
    }
}

impl Iterator for Outbox {
    type Item = OutByte;

    /// The next byte to go out; messages follow each other in their order.
    fn next(&mut self) -> Option<OutByte> {
        if self.left == 0 {
            self.left = *self.messages.get(self.at)?;
            self.at += 1;
        }
        let value = *self.messages.get(self.at)?;
        self.at += 1;
        self.left -= 1;
        Some(OutByte { value, ends_message: self.left == 0 })
    }
}

pub type Sent = Result<(), ErrorKind>;

/// A bus that empties an outbox while the processor does something else.
pub trait PanelBus {
    /// The outbox, and what has become of the messages put in last; `None` as long as they are going out.
    fn outbox(&mut self) -> Option<(&mut Outbox, Sent)>;

    /// Sends what is in the outbox; returns at once.
    fn send(&mut self);

    /// Aborts the transfer, which then has failed, and frees a bus that hangs.
    fn give_up(&mut self);
}
