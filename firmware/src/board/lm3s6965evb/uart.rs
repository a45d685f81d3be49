//! The serial port (PL011).

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;

use super::gpio;
use crate::board::register::Register;
use crate::board::serial::receiver::Inlet;
use crate::board::serial::transmitter::{Outlet, Transmitter};
use crate::config::BAUD;

// SAFETY: UART0 registers of the data sheet, chapter 12; without DMA they cannot break memory safety.
const DATA: Register = unsafe { Register::at(0x4000_C000) };
const FLAGS: Register = unsafe { Register::at(0x4000_C018) };
const DIVISOR: Register = unsafe { Register::at(0x4000_C024) };
const DIVISOR_FRACTION: Register = unsafe { Register::at(0x4000_C028) };
const LINE_CONTROL: Register = unsafe { Register::at(0x4000_C02C) };
const CONTROL: Register = unsafe { Register::at(0x4000_C030) };
const INTERRUPT_MASK: Register = unsafe { Register::at(0x4000_C038) };
const INTERRUPT_CLEAR: Register = unsafe { Register::at(0x4000_C044) };

const RECEIVER_EMPTY: u32 = 1 << 4;
const TRANSMITTER_FULL: u32 = 1 << 5;
const EIGHT_BITS_QUEUED: u32 = 0b11 << 5 | 1 << 4;
const ENABLE: u32 = 1 << 9 | 1 << 8 | 1 << 0;
const RECEIVED: u32 = 1 << 6 | 1 << 4;

/// The port, running.
#[derive(Debug)]
pub struct Port(());

/// The outward direction.
pub type Uart = Transmitter<Port>;

impl Uart {
    pub(super) fn start(hertz: u32) -> Self {
        gpio::A.use_for_device(1 << 0 | 1 << 1);
        CONTROL.write(0);
        // The divisor hertz/(16 baud) in 64ths, rounded: 50 MHz / (16 x 460,800) = 6 + 50/64, 0.005 % off.
        let divisor = (4 * hertz + BAUD / 2) / BAUD;
        DIVISOR.write(divisor / 64);
        DIVISOR_FRACTION.write(divisor % 64);
        LINE_CONTROL.write(EIGHT_BITS_QUEUED);
        CONTROL.write(ENABLE);
        Self(Port(()))
    }
}

impl Outlet for Port {
    fn is_ready(&self) -> bool {
        FLAGS.read() & TRANSMITTER_FULL == 0
    }

    fn put(&mut self, byte: u8) {
        DATA.write(byte.into());
    }
}

/// The inward direction.
pub(super) const INLET: Inlet = Inlet {
    clear: || INTERRUPT_CLEAR.write(RECEIVED),
    take: || if FLAGS.read() & RECEIVER_EMPTY == 0 { Some(DATA.read() as u8) } else { None },
};

#[derive(Clone, Copy)]
struct Interrupt;

// SAFETY: 5 is UART0's number on this chip, below the 64 that it has.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        5
    }
}

/// Lets received bytes interrupt.
pub(super) fn enable_receiver() {
    INTERRUPT_MASK.write(RECEIVED);
    // SAFETY: no critical section relies on this interrupt being masked.
    unsafe { NVIC::unmask(Interrupt) };
}
