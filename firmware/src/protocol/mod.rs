//! What travels over the serial link, both ways: the chip and the host use this same code.
//!
//! A message on the wire is `COBS(version, kind, fields, CRC)` between two zero bytes. The version and the kind are one byte
//! each; the fields of each kind are a struct here, in SI units, in postcard's format; the CRC is CRC-32/ISO-HDLC over
//! everything before it, little-endian.

mod codes;
mod link;
mod message;
mod to_chip;
mod to_host;

pub(crate) use codes::choice;
pub use codes::{BoardName, Field, NO_METHOD, limit_code, method_code, method_of};
pub use link::{CRC, Decoder, LinkError, MAX_WIRE, TO_CHIP, VERSION, encode, frame};
pub use message::{MAX_FIELDS, Message, request};
pub use to_chip::{Ask, AskPlan, Choose, Identify, Measure, Pause, Press, Request, Restart, Set, Simulate, Step};
pub use to_host::{Done, Frame, Identity, Measured, Planned, Reading, Refused, Restarted, Sample, Status, StepTooLong};
