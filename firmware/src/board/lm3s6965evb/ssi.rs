//! Synchronous serial interface 0 (PL022) as an SPI bus.

use core::convert::Infallible;

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::spi::{self, SpiBus};

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

/// The bus of the panel.
#[derive(Debug)]
pub struct Ssi(());

/// The bus did not finish in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timeout;

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

    /// Exchanges up to [`QUEUE`] bytes and passes each one received to `take`. What was received must be taken out:
    /// a full receive queue stops the bus.
    #[inline(always)]
    fn exchange(sent: &[u8], mut take: impl FnMut(usize, u8)) -> Result<(), Timeout> {
        for &byte in sent {
            DATA.write(byte.into());
        }
        if !STATUS.wait(BUSY, 0, BUS_TRIES) {
            return Err(Timeout);
        }
        for index in 0..sent.len() {
            take(index, DATA.read() as u8);
        }
        Ok(())
    }
}

impl spi::Error for Timeout {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}

impl spi::ErrorType for Ssi {
    type Error = Timeout;
}

impl SpiBus for Ssi {
    fn write(&mut self, words: &[u8]) -> Result<(), Timeout> {
        let (chunks, rest) = words.as_chunks::<QUEUE>();
        chunks.iter().try_for_each(|chunk| Self::exchange(chunk, |_, _| ()))?;
        Self::exchange(rest, |_, _| ())
    }

    fn read(&mut self, words: &mut [u8]) -> Result<(), Timeout> {
        words.fill(0);
        self.transfer_in_place(words)
    }

    fn transfer(&mut self, read: &mut [u8], write: &[u8]) -> Result<(), Timeout> {
        let both = read.len().min(write.len());
        let (read, rest_to_read) = read.split_at_mut(both);
        let (write, rest_to_write) = write.split_at(both);
        read.copy_from_slice(write);
        self.transfer_in_place(read)?;
        self.read(rest_to_read)?;
        self.write(rest_to_write)
    }

    fn transfer_in_place(&mut self, words: &mut [u8]) -> Result<(), Timeout> {
        for chunk in words.chunks_mut(QUEUE) {
            let mut sent = [0; QUEUE];
            let sent = &mut sent[..chunk.len()];
            sent.copy_from_slice(chunk);
            Self::exchange(sent, |index, byte| {
                if let Some(word) = chunk.get_mut(index) {
                    *word = byte;
                }
            })?;
        }
        Ok(())
    }

    /// Every exchange has waited for its last bit.
    fn flush(&mut self) -> Result<(), Timeout> {
        Ok(())
    }
}

/// The device select: the interface drives its pin by itself.
#[derive(Clone, Copy, Debug)]
pub struct NoSelect;

impl digital::ErrorType for NoSelect {
    type Error = Infallible;
}

impl OutputPin for NoSelect {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
