//! What travels over the serial link, both ways: the chip and the host use this same code.
//!
//! A message on the wire is `COBS(version, message, CRC)` between two zero bytes. The version is one byte; the message is a
//! [`ToHost`], or a mark, a number chosen by the host and a [`Command`], in [postcard](https://postcard.jamesmunns.com)'s
//! format and SI units; the CRC is CRC-32/ISO-HDLC over everything before it, little-endian.
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

mod command;
mod to_host;

use cobs::{CobsEncoder, DecodeResult, DecoderState};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::job::CRC;

pub use command::{Command, Field, decode_command, encode_command};
pub use to_host::{
    Answer, BoardName, Cause, Frame, Identity, PlayState, Restarted, Status, ToHost,
};

/// The version of the protocol; the first byte of every message.
pub const VERSION: u8 = 12;
/// The most bytes that a message takes by itself.
pub const MAX_MESSAGE: usize = 97;
/// The most bytes it takes before framing: with version and CRC.
const MAX_BODY: usize = 1 + MAX_MESSAGE + 4;
/// The most bytes a message takes on the wire: COBS adds one byte (bodies are below 254), the delimiters another two.
pub const MAX_WIRE: usize = MAX_BODY + 3;

/// The message as it goes over the wire, between delimiters: the front of `wire`. All messages fit (test `link`).
pub fn encode<'wire>(message: &impl Serialize, wire: &'wire mut [u8; MAX_WIRE]) -> &'wire [u8] {
    frame(
        postcard::to_slice(message, &mut [0; MAX_MESSAGE]).unwrap_or_default(),
        wire,
    )
}

/// The message in `bytes`; `None` unless they hold just that.
pub fn read<M: DeserializeOwned>(bytes: &[u8]) -> Option<M> {
    postcard::take_from_bytes(bytes)
        .ok()
        .filter(|(_, rest)| rest.is_empty())
        .map(|(message, _)| message)
}

/// Any message, given as bytes; nothing if they are more than [`MAX_MESSAGE`].
#[inline(never)] // flash has room for one of it, not for one of each kind
pub fn frame<'wire>(message: &[u8], wire: &'wire mut [u8; MAX_WIRE]) -> &'wire [u8] {
    if message.len() > MAX_MESSAGE {
        return &[];
    }
    let mut crc = CRC.digest();
    crc.update(&[VERSION]);
    crc.update(message);
    let crc = crc.finalize().to_le_bytes();
    wire.fill(0);
    let [_, inside @ ..] = wire;
    let mut encoder = CobsEncoder::new(inside);
    let framed = [&[VERSION], message, &crc]
        .into_iter()
        .try_for_each(|part| encoder.push(part));
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

impl LinkError {
    pub const fn name(self) -> &'static str {
        match self {
            Self::Malformed => "malformed",
            Self::Checksum => "wrong checksum",
            Self::Version(_) => "another version of the protocol",
        }
    }
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
        Self {
            cobs: DecoderState::default(),
            body: [0; MAX_BODY],
            received: 0,
        }
    }
}

impl Decoder {
    /// Takes one byte. At the end of a message: the message, or what is wrong with it.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8], LinkError>> {
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

/// The message in a body, if it is intact and of this version.
fn open(body: &[u8]) -> Result<&[u8], LinkError> {
    let (checked, crc) = body.split_last_chunk().ok_or(LinkError::Malformed)?;
    if CRC.checksum(checked) != u32::from_le_bytes(*crc) {
        return Err(LinkError::Checksum);
    }
    match checked {
        [VERSION, message @ ..] => Ok(message),
        [version, ..] => Err(LinkError::Version(*version)),
        [] => Err(LinkError::Malformed),
    }
}
