//! Bytes sent: each waits until the serial port takes it, but not without end.

use embedded_io::{ErrorKind, ErrorType, Write};

use crate::config::BUS_TRIES;

pub trait Outlet {
    /// Whether it takes a byte now.
    fn is_ready(&self) -> bool;

    /// Gives it a byte, once it is ready.
    fn put(&mut self, byte: u8);
}

#[derive(Debug)]
pub struct Transmitter<Port>(pub(in crate::board) Port);

impl<Port> ErrorType for Transmitter<Port> {
    type Error = ErrorKind;
}

impl<Port: Outlet> Write for Transmitter<Port> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        for &byte in bytes {
            if !(0..BUS_TRIES).any(|_| self.0.is_ready()) {
                return Err(ErrorKind::TimedOut);
            }
            self.0.put(byte);
        }
        Ok(bytes.len())
    }

    /// Bytes leave by themselves; there is nothing to wait for.
    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}
