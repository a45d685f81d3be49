//! What travels over the serial link, both ways: the chip and the host use this same code.
//!
//! A message on the wire is `COBS(version, message, CRC)` between two zero bytes. The version is one byte; the message is a
//! [`ToHost`], or a mark, a number chosen by the host and a [`Command`], in [postcard](https://postcard.jamesmunns.com)'s
//! format and SI units; the CRC is CRC-32/ISO-HDLC over everything before it, little-endian.

mod command;
mod link;
mod to_host;

pub use command::{Command, Field, decode_command, encode_command};
pub use link::{Decoder, LinkError, MAX_MESSAGE, MAX_WIRE, VERSION, encode, frame, read};
pub use to_host::{Answer, BoardName, Cause, Frame, Identity, Restarted, Status, ToHost};
