//! Bytes over a board's serial port, of any kind.

pub mod receiver;
pub mod transmitter;
