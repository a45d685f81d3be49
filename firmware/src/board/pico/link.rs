//! The serial link: the same bytes go out over USB and through UART0, and commands are taken from either. Two hosts that speak at
//! the same moment spoil each other's messages. The UART's interrupt sends what is in its queue, so no frame waits; a motion asked
//! for, whose samples may come faster than the UART sends them, waits for room in it.

use heapless::Deque;
use rp2040_hal::fugit::{HertzU32, RateExtU32};
use rp2040_hal::gpio::bank0::{Gpio0, Gpio1};
use rp2040_hal::gpio::{FunctionUart, Pin, PullNone, PullUp};
use rp2040_hal::pac::{Interrupt, NVIC, RESETS, UART0, interrupt};
use rp2040_hal::uart::{DataBits, StopBits, UartConfig, UartPeripheral};

use super::usb;
use crate::board::cortex_m::interrupt::{Shared, unmask};
use crate::board::serial::{self, Inbox, Outward};
use crate::config::{BAUD, BUS_TRIES, UART_QUEUE};

pub(super) type SerialPins = (
    Pin<Gpio0, FunctionUart, PullNone>,
    Pin<Gpio1, FunctionUart, PullUp>,
);

/// How often room for a message is waited for, which takes 2.6 ms at most: these tries take at least 8.
const TRIES: u32 = 4 * BUS_TRIES;

/// Bytes that the UART has not taken yet.
static QUEUE: Shared<Deque<u8, UART_QUEUE>> = Shared::new(Deque::new());

/// Starts the UART; `None` if no divisor of the clock makes its speed.
pub(super) fn start(
    device: UART0,
    pins: SerialPins,
    clock: HertzU32,
    resets: &mut RESETS,
) -> Option<Outward> {
    let config = UartConfig::new(BAUD.Hz(), DataBits::Eight, None, StopBits::One);
    let mut uart = UartPeripheral::new(device, pins, resets)
        .enable(config, clock)
        .ok()?;
    uart.enable_rx_interrupt();
    serial::receive_by(receive);
    Some(Outward(send))
}

fn send(bytes: &[u8]) -> bool {
    usb::send(bytes);
    let has_room = (0..TRIES).any(|_| QUEUE.with(|queue| usb::put(queue, bytes)) == Some(true));
    if has_room {
        NVIC::pend(Interrupt::UART0_IRQ);
    }
    has_room
}

fn uart() -> &'static rp2040_hal::pac::uart0::RegisterBlock {
    // SAFETY: the support library has set them up and let go of them.
    unsafe { &*UART0::ptr() }
}

/// Gives the UART as many bytes as it takes; while there are more it interrupts again when it has sent half of them.
#[interrupt]
fn UART0_IRQ() {
    QUEUE.with(|queue| {
        while uart().uartfr().read().txff().bit_is_clear()
            && let Some(byte) = queue.pop_front()
        {
            // SAFETY: any byte may be sent.
            uart().uartdr().write(|w| unsafe { w.data().bits(byte) });
        }
        uart()
            .uartimsc()
            .modify(|_, w| w.txim().bit(!queue.is_empty()));
    });
    // USB, which takes long to look at, interrupts by itself unless it waits for room.
    let waits = !NVIC::is_enabled(Interrupt::USBCTRL_IRQ);
    if waits || uart().uartfr().read().rxfe().bit_is_clear() {
        serial::receive();
    }
}

/// To look at USB and to read what has come ends the interrupts of both.
///
/// A USB packet for which there is no room stays where it is, and the host waits. As long as it does, its interrupt would come again
/// and again; meanwhile the UART's does, which is asked for with each frame. So it is with a packet
/// that USB cannot be rid of.
fn receive(inbox: &mut Inbox) {
    if usb::poll(inbox) {
        enable_interrupts();
    } else {
        NVIC::mask(Interrupt::USBCTRL_IRQ);
    }
    while uart().uartfr().read().rxfe().bit_is_clear() {
        let word = uart().uartdr().read();
        inbox.push(word.data().bits());
        inbox.note_overrun(word.oe().bit_is_set());
    }
}

/// Unmasks the interrupts of the UART and of the USB port.
pub(super) fn enable_interrupts() {
    [Interrupt::UART0_IRQ, Interrupt::USBCTRL_IRQ]
        .into_iter()
        .for_each(unmask);
}
