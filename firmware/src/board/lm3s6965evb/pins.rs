//! The general-purpose pins (PL061), and the panel's SPI bus at some of them: the synchronous
//! serial interface 0 (PL022). It is only written, and drives its select pin on its own.

use core::convert::Infallible;

use embedded_hal::digital::{self, OutputPin};
use embedded_hal::spi::{self, ErrorKind, Operation, SpiDevice};

use crate::board::register::{Device, Register};
use crate::config::BUS_TRIES;

/// A port of eight pins. In its functions, `pins` is a mask: bit n means pin n.
/// [`system::start`](super::system::start) must have powered the port: before that every access is
/// a fault.
#[derive(Clone, Copy, Debug)]
pub struct Pins(Device);

pub const A: Pins = port(0x4000_4000);
pub const C: Pins = port(0x4000_6000);
pub const D: Pins = port(0x4000_7000);
pub const E: Pins = port(0x4002_4000);
pub const F: Pins = port(0x4002_5000);

const fn port(base: usize) -> Pins {
    // SAFETY: the ports above are in the data sheet, chapter 8; pins cannot break memory safety.
    Pins(unsafe { Device::at(base) })
}

impl Pins {
    /// Returns the register that accesses only the pins of `pins`: the address contains the mask.
    const fn data(self, pins: u8) -> Register {
        self.0.register((pins as usize) << 2)
    }

    /// Connects `pins` to the device that the data sheet assigns to each of them, such as UART0 or
    /// SSI0 at port A.
    pub fn use_for_device(self, pins: u8) {
        self.0.register(0x420).modify(0, pins.into()); // alternate function
        self.0.register(0x51C).modify(0, pins.into()); // digital
    }

    pub fn use_for_input(self, pins: u8) {
        self.0.register(0x400).modify(pins.into(), 0); // direction
        self.0.register(0x510).modify(0, pins.into()); // pull-up
        self.0.register(0x51C).modify(0, pins.into());
    }

    /// Makes `pins` outputs.
    pub fn use_for_output(self, pins: u8) -> Output {
        self.0.register(0x400).modify(0, pins.into());
        self.0.register(0x51C).modify(0, pins.into());
        Output(self.data(pins))
    }

    pub fn are_low(self, pins: u8) -> bool {
        self.data(pins).read() == 0
    }
}

#[derive(Debug)]
pub struct Output(Register);

impl digital::ErrorType for Output {
    type Error = Infallible;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.write(0);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.write(u32::MAX); // The address contains the mask of the pin.
        Ok(())
    }
}

/// A bit takes at least 250 ns.
const FASTEST: u32 = 4_000_000;
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
/// Eight bits. The clock is high when idle, and data are taken on its first, falling edge.
const MODE_2_BYTES: u32 = 1 << 6 | 7;

/// The panel's SPI bus, which can only write. A transaction waits until its bytes are sent, or ends
/// with [`ErrorKind::Other`] if the bus is stuck.
#[derive(Debug)]
pub struct Ssi(());

impl Ssi {
    /// Starts the bus at the largest possible clock.
    pub(super) fn start(hertz: u32) -> Self {
        A.use_for_device(1 << 2 | 1 << 3 | 1 << 5);
        CONTROL1.write(0);
        CONTROL0.write(MODE_2_BYTES);
        // The divisor must be even: 50 MHz / 14 = 3.6 MHz.
        PRESCALE.write(hertz.div_ceil(FASTEST).next_multiple_of(2));
        CONTROL1.write(ENABLE);
        Self(())
    }
}

/// The received bytes are noise, but must be read, because a full receive queue stops the bus.
fn send(bytes: &[u8]) -> Result<(), ErrorKind> {
    for &byte in bytes {
        DATA.write(byte.into());
    }

    if !STATUS.wait(BUSY, 0, BUS_TRIES) {
        return Err(ErrorKind::Other);
    }
    for _ in bytes {
        let _ = DATA.read();
    }
    Ok(())
}

impl spi::ErrorType for Ssi {
    type Error = ErrorKind;
}

impl SpiDevice for Ssi {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        operations.iter().try_for_each(|operation| {
            // No line leads back from the panel.
            let Operation::Write(bytes) = operation else {
                return Err(ErrorKind::Other);
            };
            let (chunks, rest) = bytes.as_chunks::<QUEUE>();
            chunks.iter().try_for_each(|chunk| send(chunk))?;
            send(rest)
        })
    }
}
