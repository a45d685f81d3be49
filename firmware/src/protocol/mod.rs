//! What travels over the serial link, both ways: the chip and the host use this same code.
//!
//! A message on the wire is `COBS(version, kind, fields, CRC)` between two zero bytes. The version and the kind are
//! one byte each; the fields of each kind are listed in the tables here, little-endian and without padding; the CRC is
//! CRC-32/ISO-HDLC over everything before it, little-endian.

pub mod choice;
mod command;
mod field;
mod frame;
mod identity;
mod layout;
mod link;
mod plan;
mod restarted;
mod simulate;
mod unit;

pub use command::{Ask, Choose, Done, Pause, Press, Restart, Set, Status, Step};
pub use field::Field;
pub use frame::Frame;
pub use identity::{BoardName, Identify, Identity, Measure, Measured};
pub use layout::{Message, WireNumber};
pub use link::{CRC, Decoder, LinkError, MAX_FIELDS, MAX_WIRE, TO_CHIP, VERSION, encode, frame};
pub use plan::{AskPlan, NO_METHOD, Planned, limit_code, method_code, method_of};
pub use restarted::Restarted;
pub use simulate::{Refused, Sample, Simulate, StepTooLong};
pub use unit::Unit;
