//! The I2C bus of the panel. The support library sets it up; bytes are sent here, because the library waits for the bus
//! without end, and here there may be none.

use cortex_m::asm::delay;
use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c as Transactions, NoAcknowledgeSource, Operation};
use stm32f4xx_hal::gpio::alt::i2c1::{Scl, Sda};
use stm32f4xx_hal::gpio::{PB6, PB7, PinState};
use stm32f4xx_hal::i2c::I2c;
use stm32f4xx_hal::pac::I2C1;
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;

use crate::config::BUS_TRIES;
use crate::display::i2c_recovery::free_bus;

/// Half a clock of a slow 100 kHz, cycles of 168 MHz.
const HALF_CLOCK: u32 = 840;

const START_SENT: u16 = 1 << 0;
const ADDRESS_SENT: u16 = 1 << 1;
const ALL_SENT: u16 = 1 << 2;
const READY_FOR_BYTE: u16 = 1 << 7;
const ARBITRATION_LOST: u16 = 1 << 9;
const NOT_ACKNOWLEDGED: u16 = 1 << 10;

/// The bus, for writing only: the panel is never read.
pub struct Bus {
    port: I2C1,
    pins: (Scl, Sda),
}

/// Why bytes did not get onto the bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BusError {
    /// The bus did not move in time: no pull-up resistors, a short circuit, or no bus at all.
    Timeout,
    /// Nobody acknowledged the address.
    NoAnswer,
    /// A byte was not acknowledged.
    Refused,
    /// A line was low that should have been high.
    ArbitrationLost,
    /// This bus does not read.
    Read,
}

impl Error for BusError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Timeout | Self::Read => ErrorKind::Other,
            Self::NoAnswer => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address),
            Self::Refused => ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data),
            Self::ArbitrationLost => ErrorKind::ArbitrationLoss,
        }
    }
}

impl ErrorType for Bus {
    type Error = BusError;
}

impl Bus {
    pub(super) fn start(port: I2C1, clock: PB6, data: PB7, rcc: &mut Rcc) -> Self {
        let (port, pins) = I2c::new(port, (clock, data), 400.kHz(), rcc).release();
        let mut bus = Self { port, pins };
        bus.reset();
        bus
    }

    fn send(&self, address: u8, operations: &[Operation]) -> Result<(), BusError> {
        self.port.cr1().modify(|_, w| w.start().set_bit());
        self.wait(START_SENT, BusError::Timeout)?;
        self.put(address << 1);
        self.wait(ADDRESS_SENT, BusError::NoAnswer)?;
        let _ = self.port.sr2().read(); // Only this ends the address phase.
        for operation in operations {
            let Operation::Write(bytes) = operation else { return Err(BusError::Read) };
            for &byte in *bytes {
                self.wait(READY_FOR_BYTE, BusError::Refused)?;
                self.put(byte);
            }
        }
        self.wait(ALL_SENT, BusError::Refused)
    }

    fn put(&self, byte: u8) {
        self.port.dr().write(|w| w.dr().set(byte));
    }

    /// Waits for a status bit; `refusal` if instead the panel does not acknowledge.
    fn wait(&self, wanted: u16, refusal: BusError) -> Result<(), BusError> {
        for _ in 0..BUS_TRIES {
            let status = self.port.sr1().read().bits();
            if status & NOT_ACKNOWLEDGED != 0 {
                return Err(refusal);
            }
            if status & ARBITRATION_LOST != 0 {
                return Err(BusError::ArbitrationLost);
            }
            if status & wanted != 0 {
                return Ok(());
            }
        }
        Err(BusError::Timeout)
    }

    /// Releases the bus; whether it came free in time.
    fn stop(&self) -> bool {
        self.port.sr1().write(|w| w.af().clear_bit());
        self.port.cr1().modify(|_, w| w.stop().set_bit());
        (0..BUS_TRIES).any(|_| self.port.cr1().read().stop().bit_is_clear())
    }

    /// Frees a bus that hangs, and makes the device forget it; its settings stay.
    fn reset(&mut self) {
        if let (Scl::PB6(clock), Sda::PB7(data)) = &mut self.pins {
            clock.with_open_drain_output_in_state(PinState::High, |clock| {
                data.with_open_drain_output_in_state(PinState::High, |data| free_bus(clock, data, || delay(HALF_CLOCK)))
            });
        }
        let port = &self.port;
        let (frequency, clock, rise) = (port.cr2().read().bits(), port.ccr().read().bits(), port.trise().read().bits());
        port.cr1().write(|w| w.swrst().set_bit());
        port.cr1().write(|w| w.swrst().clear_bit());
        // SAFETY: they are what these registers held before.
        port.cr2().write(|w| unsafe { w.bits(frequency) });
        // SAFETY: as above.
        port.ccr().write(|w| unsafe { w.bits(clock) });
        // SAFETY: as above.
        port.trise().write(|w| unsafe { w.bits(rise) });
        port.cr1().write(|w| w.pe().set_bit());
    }
}

impl Transactions for Bus {
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), BusError> {
        let sent = self.send(address, operations);
        let free = self.stop();
        if !free || matches!(sent, Err(BusError::Timeout | BusError::ArbitrationLost)) {
            self.reset();
        }
        sent
    }
}
