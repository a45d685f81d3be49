//! General-purpose pins (PL061).

use core::convert::Infallible;

use embedded_hal::digital::{ErrorType, OutputPin};

use crate::board::register::{Device, Register};

#[derive(Clone, Copy, Debug)]
pub struct Pins(Device);

pub const A: Pins = port(0x4000_4000);
pub const C: Pins = port(0x4000_6000);
pub const D: Pins = port(0x4000_7000);
pub const E: Pins = port(0x4002_4000);
pub const F: Pins = port(0x4002_5000);

const fn port(base: usize) -> Pins {
    // SAFETY: the ports above are those of the data sheet, chapter 8; pins cannot break memory safety.
    Pins(unsafe { Device::at(base) })
}

impl Pins {
    /// Reads and writes only the pins of `pins`: the address carries the mask.
    const fn data(self, pins: u8) -> Register {
        self.0.register((pins as usize) << 2)
    }

    /// Hands `pins` over to the port's serial device.
    pub fn use_for_device(self, pins: u8) {
        self.0.register(0x420).modify(0, pins.into()); // alternate function
        self.0.register(0x51C).modify(0, pins.into()); // digital
    }

    /// Makes `pins` inputs, held high unless something pulls them low.
    pub fn use_for_input(self, pins: u8) {
        self.0.register(0x400).modify(pins.into(), 0); // direction
        self.0.register(0x510).modify(0, pins.into()); // pull-up
        self.0.register(0x51C).modify(0, pins.into());
    }

    pub fn use_for_output(self, pins: u8) -> Output {
        self.0.register(0x400).modify(0, pins.into());
        self.0.register(0x51C).modify(0, pins.into());
        Output(self.data(pins))
    }

    /// Which of `pins` are high.
    pub fn read(self, pins: u8) -> u8 {
        self.data(pins).read() as u8
    }
}

#[derive(Debug)]
pub struct Output(Register);

impl ErrorType for Output {
    type Error = Infallible;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.0.write(0);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.0.write(u32::MAX); // The address lets only this pin change.
        Ok(())
    }
}
