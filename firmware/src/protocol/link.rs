//! Framing and checking: messages to bytes and back.
//!
//! # What gets past the check
//!
//! CRC-32/ISO-HDLC detects every change of up to four bits in a body (test `link`), and of any other damage all but one
//! in 2^32 = 4.3e9. A flipped bit on the wire may do more than that to the body, for it may make or unmake a zero, which
//! moves bytes: of ten million frames sent through a link that flips one bit in 10,000, half a million are damaged, and
//! the chance that a single one of them is taken for good is 550,000/2^32 = 1.3e-4. Tests `link` and
//! `random_input` try it.
//!
//! A delimiter stands before and after each message, so that one that arrives intact is recovered whatever happened to
//! those before and after it; what is missing shows in the sequence numbers of the frames.
//!
//! # When the host stops reading
//!
//! The board waits for its serial port a bounded time, then drops the message and goes on: the motion never waits for
//! the host. The frames dropped are missing from the sequence.

use cobs::{CobsEncoder, DecodeResult, DecoderState};
use crc::{CRC_32_ISO_HDLC, Crc, Table};

use super::{MAX_FIELDS, Message};

/// The version of the protocol; the first byte of every message.
pub const VERSION: u8 = 10;
/// Set in the kind of every message to the chip, and in no other's.
pub const TO_CHIP: u8 = 0x80;
/// The most bytes a message takes before framing: version, kind, fields, CRC.
const MAX_BODY: usize = 2 + MAX_FIELDS + 4;
/// The most bytes a message takes on the wire: COBS adds one byte (bodies are below 254), the delimiters another two.
pub const MAX_WIRE: usize = MAX_BODY + 3;

/// The reflected CRC-32 of zip and Ethernet.
pub const CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// The message as it goes over the wire, between delimiters: the front of `wire`.
pub fn encode<'wire, M: Message>(message: &M, wire: &'wire mut [u8; MAX_WIRE]) -> &'wire [u8] {
    frame(M::KIND, message.write(&mut [0; MAX_FIELDS]), wire)
}

/// A message of any kind, its fields being given as bytes; nothing if they are more than [`MAX_FIELDS`].
#[inline(never)] // flash has room for one of it, not for one of each kind
pub fn frame<'wire>(kind: u8, fields: &[u8], wire: &'wire mut [u8; MAX_WIRE]) -> &'wire [u8] {
    if fields.len() > MAX_FIELDS {
        return &[];
    }
    let head = [VERSION, kind];
    let mut crc = CRC.digest();
    crc.update(&head);
    crc.update(fields);
    let crc = crc.finalize().to_le_bytes();
    wire.fill(0);
    let [_, inside @ ..] = wire;
    let mut encoder = CobsEncoder::new(inside);
    let framed = [&head, fields, &crc].into_iter().try_for_each(|part| encoder.push(part));
    debug_assert!(framed.is_ok());
    let end = 1 + encoder.finalize();
    wire.get(..=end).unwrap_or_default()
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum LinkError {
    /// Not a COBS encoding, or shorter or longer than any message.
    Malformed,
    Checksum,
    /// The sender speaks another version.
    Version(u8),
}

/// Cuts a byte stream into checked messages; resynchronises at the next delimiter after any damage.
#[derive(Debug)]
pub struct Decoder {
    cobs: DecoderState,
    body: [u8; MAX_BODY],
    /// Bytes of the body received since the last delimiter; beyond the longest body they are counted but not kept.
    received: usize,
}

impl Default for Decoder {
    fn default() -> Self {
        Self { cobs: DecoderState::default(), body: [0; MAX_BODY], received: 0 }
    }
}

impl Decoder {
    /// Takes one byte. At the end of a message: its kind and its fields, or what is wrong with it.
    pub fn push(&mut self, byte: u8) -> Option<Result<(u8, &[u8]), LinkError>> {
        match self.cobs.feed(byte) {
            Ok(DecodeResult::NoData | DecodeResult::DataStart) => None,
            Ok(DecodeResult::DataContinue(byte)) => {
                if let Some(place) = self.body.get_mut(self.received) {
                    *place = byte;
                }
                self.received = self.received.saturating_add(1);
                None
            }
            Ok(DecodeResult::DataComplete) => {
                let body = self.body.get(..core::mem::take(&mut self.received));
                Some(body.ok_or(LinkError::Malformed).and_then(open))
            }
            Err(_) => {
                self.received = 0;
                Some(Err(LinkError::Malformed))
            }
        }
    }
}

/// The kind and the fields of a body, if it is intact and of this version.
fn open(body: &[u8]) -> Result<(u8, &[u8]), LinkError> {
    let (checked, crc) = body.split_last_chunk().ok_or(LinkError::Malformed)?;
    if CRC.checksum(checked) != u32::from_le_bytes(*crc) {
        return Err(LinkError::Checksum);
    }
    match checked {
        [VERSION, kind, fields @ ..] => Ok((*kind, fields)),
        [version, ..] => Err(LinkError::Version(*version)),
        [] => Err(LinkError::Malformed),
    }
}
