//! Synchronous serial interface 0 (PL022) as the panel's SPI bus, which is written only and drives its select pin by itself.

use embedded_hal::spi::{Error, ErrorKind, ErrorType, Operation, SpiDevice};

use super::gpio;
use crate::board::register::{Device, Register};
use crate::config::BUS_TRIES;

/// The panel takes a bit in no less than 250 ns: at most 4 MHz.
const FASTEST: u32 = 4_000_000;
/// Bytes that fit into the transmit queue, and as many into the receive queue.
const QUEUE: usize = 8;

// SAFETY: SSI0 of the data sheet, chapter 13; without DMA it cannot break memory safety.
const SSI0: Device = unsafe { Device::at(0x4000_8000) };
const CONTROL0: Register = SSI0.register(0x000);
const CONTROL1: Register = SSI0.register(0x004);
const DATA: Register = SSI0.register(0x008);
const STATUS: Register = SSI0.register(0x00c);
const PRESCALE: Register = SSI0.register(0x010);

const ENABLE: u32 = 1 << 1;
const BUSY: u32 = 1 << 4;
/// Eight bits, clock idles high and data are taken on its first, falling edge.
const MODE_2_BYTES: u32 = 1 << 6 | 7;

#[derive(Debug)]
pub struct Ssi(());

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SsiError {
    Late,
    /// No wire leads back from the panel.
    WriteOnly,
}

impl Ssi {
    pub(super) fn start(hertz: u32) -> Self {
        gpio::A.use_for_device(1 << 2 | 1 << 3 | 1 << 5);
        CONTROL1.write(0);
        CONTROL0.write(MODE_2_BYTES);
        // The divisor must be even: 50 MHz / 14 = 3.6 MHz.
        PRESCALE.write(hertz.div_ceil(FASTEST).next_multiple_of(2));
        CONTROL1.write(ENABLE);
        Self(())
    }
}

/// Sends up to [`QUEUE`] bytes. What comes back is noise, but must be taken out: a full receive queue stops the bus.
#[inline(always)]
fn send(bytes: &[u8]) -> Result<(), SsiError> {
    for &byte in bytes {
        DATA.write(byte.into());
    }
    if !STATUS.wait(BUSY, 0, BUS_TRIES) {
        return Err(SsiError::Late);
    }
    for _ in bytes {
        let _ = DATA.read();
    }
    Ok(())
}

impl Error for SsiError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl ErrorType for Ssi {
    type Error = SsiError;
}

impl SpiDevice for Ssi {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), SsiError> {
        operations.iter().try_for_each(|operation| {
            let Operation::Write(bytes) = operation else { return Err(SsiError::WriteOnly) };
            let (chunks, rest) = bytes.as_chunks::<QUEUE>();
            chunks.iter().try_for_each(|chunk| send(chunk))?;
            send(rest)
        })
    }
}
