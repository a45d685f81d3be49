//! Bytes over a board's serial port, whatever port that is.

pub mod receiver;
pub mod transmitter;
