//! Framing and checking: messages to bytes and back.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

use super::Message;

/// The version of the protocol; the first byte of every message.
pub const VERSION: u8 = 2;
/// The most bytes a message's fields may take.
pub const MAX_FIELDS: usize = 96;
/// The most bytes a message takes before framing: version, kind, fields, CRC.
const MAX_BODY: usize = 2 + MAX_FIELDS + 4;
/// The most bytes a message takes on the wire: COBS adds one byte (bodies are below 254), the delimiter another.
pub const MAX_WIRE: usize = MAX_BODY + 2;

const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// The message as it goes over the wire, delimiter included: the front of `wire`.
pub fn encode<'wire, M: Message>(message: &M, wire: &'wire mut [u8; MAX_WIRE]) -> &'wire [u8] {
    const { assert!(M::SIZE <= MAX_FIELDS) };
    let mut body = [0; MAX_BODY];
    body[0] = VERSION;
    body[1] = M::KIND;
    let checked = 2 + M::SIZE;
    let written = message.write(&mut &mut body[2..checked]);
    debug_assert!(written.is_some());
    let crc = CRC.checksum(&body[..checked]).to_le_bytes();
    body[checked..checked + 4].copy_from_slice(&crc);
    let framed = cobs::encode(&body[..checked + 4], wire);
    wire[framed] = 0;
    &wire[..=framed]
}

/// Why received bytes are not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum LinkError {
    /// More bytes without a delimiter than any message has.
    TooLong,
    /// Not a COBS encoding, or shorter than the shortest message.
    Malformed,
    /// The CRC does not match.
    Checksum,
    /// The sender speaks another version.
    Version(u8),
}

/// Cuts a byte stream into checked messages; resynchronises at the next delimiter after any damage.
#[derive(Debug)]
pub struct Decoder {
    buffer: [u8; MAX_WIRE],
    /// Bytes received since the last delimiter; beyond the buffer they are counted but not kept.
    received: usize,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { buffer: [0; MAX_WIRE], received: 0 }
    }
}

impl Decoder {
    /// Takes one byte. At the end of a message: its kind and its fields, or what is wrong with it.
    pub fn push(&mut self, byte: u8) -> Option<Result<(u8, &[u8]), LinkError>> {
        if byte != 0 {
            if let Some(slot) = self.buffer.get_mut(self.received) {
                *slot = byte;
            }
            self.received = self.received.saturating_add(1);
            return None;
        }
        match core::mem::take(&mut self.received) {
            0 => None, // Repeated delimiters are idle time, not messages.
            received => Some(self.open(received)),
        }
    }

    fn open(&mut self, received: usize) -> Result<(u8, &[u8]), LinkError> {
        let wire = self.buffer.get_mut(..received).ok_or(LinkError::TooLong)?;
        let body = cobs::decode_in_place(wire).map_err(|_| LinkError::Malformed)?;
        let (checked, crc) = wire[..body].split_last_chunk().ok_or(LinkError::Malformed)?;
        if CRC.checksum(checked) != u32::from_le_bytes(*crc) {
            return Err(LinkError::Checksum);
        }
        match checked {
            [VERSION, kind, fields @ ..] => Ok((*kind, fields)),
            [version, ..] => Err(LinkError::Version(*version)),
            [] => Err(LinkError::Malformed),
        }
    }
}
