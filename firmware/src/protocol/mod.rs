//! The protocol of the serial link, in both directions. The chip and the host use this same code.
//!
//! A message on the wire is `COBS(version, message, CRC)` between two zero bytes. The message is a
//! [`ToHost`]; or it is a mark byte, a number chosen by the host and a [`Command`]. Its format is
//! [postcard](https://postcard.jamesmunns.com). Units are SI, except that the angles of
//! [`Settings`](crate::motion::Settings) are in degrees. The CRC is the CRC-32/ISO-HDLC of all
//! bytes before it, little-endian.
//!
//! # Undetected errors
//!
//! CRC-32/ISO-HDLC detects every change of up to four bits in a body (test `link`). Of other errors
//! it misses one in 2^32.
//!
//! Every message has a delimiter before and after it, so that a message that arrives intact is
//! recovered even if its neighbours are damaged.
//!
//! # When the host stops reading
//!
//! The board waits for its serial port for a bounded time. Then it drops the message, so that the
//! motion never waits for the host.

mod command;
mod to_host;

use cobs::{CobsEncoder, DecodeResult, DecoderState};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::job::CRC;

pub use command::{Command, Field, decode_command, encode_command, in_range};
pub use to_host::{
    Answer, BoardName, Cause, Frame, Identity, PlayState, Restarted, Status, ToHost,
};

/// The version of the protocol: the first byte of every message. A receiver refuses any other.
pub const VERSION: u8 = 14;
/// The largest size of a message without version and CRC, bytes.
pub const MAX_MESSAGE: usize = 133;
const MAX_BODY: usize = 1 + MAX_MESSAGE + 4;
/// The largest size of a message on the wire. Version and CRC add five bytes, COBS adds one,
/// because these bytes are fewer than 254, and the delimiters add two.
pub const MAX_WIRE: usize = MAX_BODY + 3;

/// Encodes a message, and returns the used part of `wire`. All messages fit (test `link`).
pub fn encode<'wire>(message: &impl Serialize, wire: &'wire mut [u8; MAX_WIRE]) -> &'wire [u8] {
    frame(
        postcard::to_slice(message, &mut [0; MAX_MESSAGE]).unwrap_or_default(),
        wire,
    )
}

/// Returns the message in `bytes`; `None` if they are not exactly one message of type `M`.
pub fn read<M: DeserializeOwned>(bytes: &[u8]) -> Option<M> {
    postcard::take_from_bytes(bytes)
        .ok()
        .filter(|(_, rest)| rest.is_empty())
        .map(|(message, _)| message)
}

pub fn frame<'wire>(message: &[u8], wire: &'wire mut [u8; MAX_WIRE]) -> &'wire [u8] {
    if message.len() > MAX_MESSAGE {
        return &[];
    }

    let mut crc = CRC.digest();
    crc.update(&[VERSION]);
    crc.update(message);
    let crc = crc.finalize().to_le_bytes();

    // The delimiters are the zeros before and after the encoded bytes.
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
    Malformed,
    Checksum,
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

/// A decoder of a byte stream. After damage it resynchronises at the next delimiter.
#[derive(Debug)]
pub struct Decoder {
    cobs: DecoderState,
    body: [u8; MAX_BODY],
    /// The size of the body until now. Bytes beyond the longest body are counted but not kept.
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
    /// Takes one byte. At the end of a message returns it without version and CRC, or its error.
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
