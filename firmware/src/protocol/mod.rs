//! The protocol of the serial link, in both directions. The chip and the host use this same code.
//!
//! A message on the wire is `COBS(version, message, CRC)` between two zero bytes. The version is
//! one byte. The message is a [`ToHost`]; or it is a mark byte, a number chosen by the host and a
//! [`Command`]. Its format is [postcard](https://postcard.jamesmunns.com). Its units are SI units,
//! except that the angles of [`Settings`](crate::motion::Settings), in [`Command::Play`] and
//! [`Status`], are in degrees. The CRC is the CRC-32/ISO-HDLC of all bytes before it,
//! little-endian.
//!
//! # Undetected errors
//!
//! CRC-32/ISO-HDLC detects every change of up to four bits in a body (test `link`). Of other errors
//! it misses one in 2^32 = 4.3e9.
//!
//! A flipped bit on the wire can change more than one bit of the body, because it can create or
//! remove a zero, which moves bytes. Of ten million frames on a link that flips one bit in 10,000,
//! half a million are damaged. The probability that a single one of them is accepted is
//! 550,000/2^32 = 1.3e-4. The tests `link` and `random_input` try it.
//!
//! Every message has a delimiter before and after it. So a message that arrives intact is
//! recovered even if its neighbours are damaged. The sequence numbers of the frames show which
//! ones are missing.
//!
//! # When the host stops reading
//!
//! The board waits for its serial port for a bounded time. Then it drops the message and continues,
//! so that the motion never waits for the host. Dropped frames are missing from the sequence.

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

/// The version of the protocol. It precedes every message, as the first byte that COBS encodes. A
/// receiver refuses messages with any other version ([`LinkError::Version`]).
pub const VERSION: u8 = 12;
/// The largest size of a message without version and CRC, bytes.
pub const MAX_MESSAGE: usize = 97;
/// The largest size of a message before framing, with version and CRC, bytes.
const MAX_BODY: usize = 1 + MAX_MESSAGE + 4;
/// The largest size of a message on the wire, 105 bytes. Version and CRC add five bytes, COBS adds
/// one, because these bytes are fewer than 254, and the delimiters add two.
pub const MAX_WIRE: usize = MAX_BODY + 3;

/// Encodes a message for the wire, with version, CRC and delimiters. Returns the used part of
/// `wire`, which begins and ends with a zero; the rest of `wire` is zeros. The type of the message
/// is not encoded. Of a command only [`encode_command`] adds the mark byte and the number.
///
/// All messages fit (test `link`). In place of one that is longer than [`MAX_MESSAGE`], or cannot
/// be serialised, an intact message of 0 bytes is encoded.
pub fn encode<'wire>(message: &impl Serialize, wire: &'wire mut [u8; MAX_WIRE]) -> &'wire [u8] {
    frame(
        postcard::to_slice(message, &mut [0; MAX_MESSAGE]).unwrap_or_default(),
        wire,
    )
}

/// Returns the message in `bytes`, which are without version and CRC, as [`Decoder::push`] returns
/// them; `None` unless they are exactly one message of type `M`. Its numbers are not checked: they
/// may be NaN. Commands, with their mark byte and number, are read by [`decode_command`].
pub fn read<M: DeserializeOwned>(bytes: &[u8]) -> Option<M> {
    postcard::take_from_bytes(bytes)
        .ok()
        .filter(|(_, rest)| rest.is_empty())
        .map(|(message, _)| message)
}

/// Frames a message of bytes for the wire: adds version, CRC, COBS and delimiters. Returns the used
/// part of `wire`, which begins and ends with a zero; the rest of `wire` is zeros. The message may
/// be empty. If it is longer than [`MAX_MESSAGE`], the result is empty, and `wire` is unchanged.
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

/// The reason why received bytes are not an intact message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum LinkError {
    /// The bytes are not a COBS encoding, or decode to fewer bytes than a CRC (4), to nothing but a
    /// matching CRC, or to more bytes than the longest message with version and CRC (102).
    Malformed,
    /// The CRC, the last four bytes, does not match. It is checked before the version.
    Checksum,
    /// The CRC matches, but the sender uses this other version of the protocol.
    Version(u8),
}

impl LinkError {
    /// Returns the error in words, such as `wrong checksum`. The version is not in them.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Malformed => "malformed",
            Self::Checksum => "wrong checksum",
            Self::Version(_) => "another version of the protocol",
        }
    }
}

/// A decoder that splits a byte stream into checked messages. The default one expects the beginning
/// of a message. After damage it resynchronises at the next delimiter. A stream that it receives
/// from the middle of a message on begins with an error, as a rule.
#[derive(Debug)]
pub struct Decoder {
    cobs: DecoderState,
    body: [u8; MAX_BODY],
    /// The number of bytes of the body received since the last delimiter. Bytes beyond the longest
    /// body are counted but not kept.
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
    /// Takes one byte. At the end of a message returns the message without version and CRC, or its
    /// error; otherwise `None`. The end is the zero byte after the message. Repeated delimiters are
    /// ignored. The message may be empty; only [`read`] and [`decode_command`] check whether it is
    /// a known one.
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

/// Returns the message in a body if it is intact and of this version.
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
