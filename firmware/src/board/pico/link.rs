//! The serial link: the same bytes go out over USB and through UART0, and commands are taken from either. Two hosts that speak at
//! the same moment spoil each other's messages.

use embedded_io::{ErrorType, Write};
use rp2040_hal::fugit::{HertzU32, RateExtU32};
use rp2040_hal::gpio::bank0::{Gpio0, Gpio1};
use rp2040_hal::gpio::{FunctionUart, Pin, PullNone, PullUp};
use rp2040_hal::pac::{Interrupt, NVIC, RESETS, UART0};
use rp2040_hal::uart::{DataBits, StopBits, UartConfig, UartPeripheral};

use super::usb;
use crate::board::serial::receiver::{Inlet, Taken};
use crate::board::serial::transmitter::{Outlet, Timeout, Transmitter};
use crate::config::BAUD;

/// Both pins of UART0.
pub(super) type SerialPins = (Pin<Gpio0, FunctionUart, PullNone>, Pin<Gpio1, FunctionUart, PullUp>);

/// The outward direction.
pub struct Link(Transmitter<Port>);

/// UART0, running.
struct Port(());

impl Link {
    /// Starts the UART; `None` if no divisor of the clock makes its speed.
    pub(super) fn start(device: UART0, pins: SerialPins, clock: HertzU32, resets: &mut RESETS) -> Option<Self> {
        let config = UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
        let mut uart = UartPeripheral::new(device, pins, resets).enable(config, clock).ok()?;
        uart.enable_rx_interrupt();
        Some(Self(Transmitter(Port(()))))
    }
}

impl ErrorType for Link {
    type Error = Timeout;
}

impl Write for Link {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Timeout> {
        usb::send(bytes);
        self.0.write(bytes)
    }

    fn flush(&mut self) -> Result<(), Timeout> {
        Ok(())
    }
}

/// Its registers.
fn uart() -> &'static rp2040_hal::pac::uart0::RegisterBlock {
    // SAFETY: the support library has set them up and let go of them.
    unsafe { &*UART0::ptr() }
}

impl Outlet for Port {
    fn is_ready(&self) -> bool {
        uart().uartfr().read().txff().bit_is_clear()
    }

    fn put(&mut self, byte: u8) {
        // SAFETY: any byte may be sent.
        uart().uartdr().write(|w| unsafe { w.data().bits(byte) });
    }
}

/// The inward direction: to look at USB and to read what has come ends the interrupts of both.
pub(super) const INLET: Inlet = Inlet { clear: usb::poll, take };

fn take() -> Taken {
    if uart().uartfr().read().rxfe().bit_is_set() {
        return Taken { byte: usb::take(), overrun: false };
    }
    let word = uart().uartdr().read();
    Taken { byte: Some(word.data().bits()), overrun: word.oe().bit_is_set() }
}

/// Lets received bytes interrupt, and whatever else happens at the USB port.
pub(super) fn enable_receivers() {
    for interrupt in [Interrupt::UART0_IRQ, Interrupt::USBCTRL_IRQ] {
        // SAFETY: no critical section relies on these being masked.
        unsafe { NVIC::unmask(interrupt) };
    }
}
