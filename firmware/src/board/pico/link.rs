//! The serial link: the same bytes go out over USB and through UART0, and commands are taken from either. Two hosts that speak at
//! the same moment spoil each other's messages. The UART's interrupt sends what is in its queue, so no frame waits; a motion asked
//! for, whose samples may come faster than the UART sends them, waits for room in it.

use embedded_io::{ErrorKind, ErrorType, Write};
use heapless::Deque;
use rp2040_hal::fugit::{HertzU32, RateExtU32};
use rp2040_hal::gpio::bank0::{Gpio0, Gpio1};
use rp2040_hal::gpio::{FunctionUart, Pin, PullNone, PullUp};
use rp2040_hal::pac::{Interrupt, NVIC, RESETS, UART0, interrupt};
use rp2040_hal::uart::{DataBits, StopBits, UartConfig, UartPeripheral};

use super::usb;
use crate::board::cortex_m::interrupt::Shared;
use crate::board::serial::{self, Inward, Taken};
use crate::config::{BAUD, BUS_TRIES, UART_QUEUE};

pub(super) type SerialPins = (Pin<Gpio0, FunctionUart, PullNone>, Pin<Gpio1, FunctionUart, PullUp>);

/// How often room for a message is waited for, which takes 2.6 ms at most: these tries take at least 8.
const TRIES: u32 = 4 * BUS_TRIES;

/// Bytes that the UART has not taken yet.
static QUEUE: Shared<Deque<u8, UART_QUEUE>> = Shared::new(Deque::new());

pub struct Link(());

impl Link {
    /// Starts the UART; `None` if no divisor of the clock makes its speed.
    pub(super) fn start(device: UART0, pins: SerialPins, clock: HertzU32, resets: &mut RESETS) -> Option<Self> {
        let config = UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
        let mut uart = UartPeripheral::new(device, pins, resets).enable(config, clock).ok()?;
        uart.enable_rx_interrupt();
        Some(Self(()))
    }
}

impl ErrorType for Link {
    type Error = ErrorKind;
}

impl Write for Link {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, ErrorKind> {
        usb::send(bytes);
        if !(0..TRIES).any(|_| put(bytes)) {
            return Err(ErrorKind::TimedOut);
        }
        NVIC::pend(Interrupt::UART0_IRQ);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), ErrorKind> {
        Ok(())
    }
}

fn uart() -> &'static rp2040_hal::pac::uart0::RegisterBlock {
    // SAFETY: the support library has set them up and let go of them.
    unsafe { &*UART0::ptr() }
}

/// Puts a message into the queue, if there is room for all of it.
fn put(message: &[u8]) -> bool {
    let put = QUEUE.with(|queue| {
        let has_room = queue.capacity().saturating_sub(queue.len()) >= message.len();
        if has_room {
            for &byte in message {
                let _ = queue.push_back(byte);
            }
        }
        has_room
    });
    put.unwrap_or_default()
}

#[interrupt]
fn UART0_IRQ() {
    pass_on();
    serial::receive();
}

/// Gives the UART as many bytes as it takes; while there are more it interrupts again when it has sent half of them.
fn pass_on() {
    QUEUE.with(|queue| {
        while uart().uartfr().read().txff().bit_is_clear()
            && let Some(byte) = queue.pop_front()
        {
            // SAFETY: any byte may be sent.
            uart().uartdr().write(|w| unsafe { w.data().bits(byte) });
        }
        uart().uartimsc().modify(|_, w| w.txim().bit(!queue.is_empty()));
    });
}

/// To look at USB and to read what has come ends the interrupts of both.
pub(super) const INWARD: Inward = Inward { clear, take };

/// A USB packet for which there is no room stays where it is, and the host waits. As long as it does, its interrupt would come again
/// and again; meanwhile the UART's does, which is asked for with each frame.
fn clear(room: usize) {
    let has_room = room >= usb::PACKET;
    usb::poll(has_room);
    if has_room {
        enable_interrupts();
    } else {
        NVIC::mask(Interrupt::USBCTRL_IRQ);
    }
}

/// First what has come over USB, for which the room was reckoned.
fn take() -> Taken {
    let byte = usb::take();
    if byte.is_some() || uart().uartfr().read().rxfe().bit_is_set() {
        return Taken { byte, overrun: false };
    }
    let word = uart().uartdr().read();
    Taken { byte: Some(word.data().bits()), overrun: word.oe().bit_is_set() }
}

/// Unmasks the interrupts of the UART and of the USB port.
pub(super) fn enable_interrupts() {
    for interrupt in [Interrupt::UART0_IRQ, Interrupt::USBCTRL_IRQ] {
        // SAFETY: no critical section relies on these being masked.
        unsafe { NVIC::unmask(interrupt) };
    }
}
