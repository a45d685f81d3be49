//! The serial port.

use embedded_io::{Error, ErrorKind, ErrorType, Write};
use stm32f4xx_hal::gpio::{PB10, PB11};
use stm32f4xx_hal::pac::{Interrupt, NVIC, USART3};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::serial::config::{Config, InvalidConfig};
use stm32f4xx_hal::serial::{Event, Tx};

use crate::board::receiver::Port;
use crate::config::BAUD;

/// A byte leaves in 10/460,800 s = 22 us or 3,646 cycles of 168 MHz, and a try takes at least 4.
const TRIES: u32 = 10_000;

/// The outward direction.
pub struct Uart(Tx<USART3>);

/// The port did not take a byte in time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timeout;

impl Uart {
    pub(super) fn start(port: USART3, (out, inwards): (PB10, PB11), rcc: &mut Rcc) -> Result<Self, InvalidConfig> {
        let mut port = port.serial((out, inwards), Config::default().baudrate(BAUD.bps()), rcc)?;
        port.listen(Event::RxNotEmpty);
        Ok(Self(port.split().0))
    }
}

impl core::fmt::Display for Timeout {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the serial port did not take a byte in time")
    }
}

impl core::error::Error for Timeout {}

impl Error for Timeout {
    fn kind(&self) -> ErrorKind {
        ErrorKind::TimedOut
    }
}

impl ErrorType for Uart {
    type Error = Timeout;
}

impl Write for Uart {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Timeout> {
        for &byte in bytes {
            if !(0..TRIES).any(|_| self.0.is_tx_empty()) {
                return Err(Timeout);
            }
            self.0.write(byte).map_err(|_| Timeout)?;
        }
        Ok(bytes.len())
    }

    /// Bytes leave by themselves; there is nothing to wait for.
    fn flush(&mut self) -> Result<(), Timeout> {
        Ok(())
    }
}

/// The inward direction.
pub(super) const PORT: Port = Port { clear: || (), take };

/// The next byte, if there is one. To read it ends its interrupt; there is nothing else to clear.
fn take() -> Option<u8> {
    // SAFETY: of these registers the outward direction uses other bits, and reading does not change those.
    let port = unsafe { &*USART3::ptr() };
    let status = port.sr().read();
    // A byte that came before the last one was read is lost, and interrupts until the data are read.
    if status.rxne().bit_is_clear() && status.ore().bit_is_clear() {
        return None;
    }
    let byte = port.dr().read().dr().bits() as u8;
    status.rxne().bit_is_set().then_some(byte)
}

/// Lets received bytes interrupt.
pub(super) fn enable_receiver() {
    // SAFETY: no critical section relies on this interrupt being masked.
    unsafe { NVIC::unmask(Interrupt::USART3) };
}
