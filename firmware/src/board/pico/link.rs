//! The serial link. The same bytes are sent over USB and through UART0, and commands are taken from
//! either.
//!
//! Two hosts that send at the same time corrupt each other's messages. The UART's interrupt sends
//! the bytes in its queue, so that no frame waits. The samples of a job may come faster than the
//! UART sends them; they wait for room in the queue.

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

/// The number of tries to wait for room for a message. It takes 2.6 ms at most, and these tries
/// take at least 8 ms.
const TRIES: u32 = 4 * BUS_TRIES;

/// The bytes that the UART has not taken yet.
static QUEUE: Shared<Deque<u8, UART_QUEUE>> = Shared::new(Deque::new());

/// Starts the UART, and returns the sending direction of UART and USB; `None` if no divisor of
/// `clock` gives the UART's speed.
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

/// Sends a message over USB and the UART. The result is that of the UART.
fn send(bytes: &[u8]) -> bool {
    usb::send(bytes);
    let has_room = (0..TRIES).any(|_| QUEUE.with(|queue| usb::put(queue, bytes)) == Some(true));
    if has_room {
        NVIC::pend(Interrupt::UART0_IRQ);
    }
    has_room
}

fn uart() -> &'static rp2040_hal::pac::uart0::RegisterBlock {
    // SAFETY: the support library has set the registers up and uses them no longer.
    unsafe { &*UART0::ptr() }
}

/// Passes bytes to the UART while it takes them. If bytes are left, it interrupts again when it has
/// sent half of them.
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

    // Polling USB takes long. It has an interrupt of its own, unless that is masked while USB waits
    // for room.
    let waits = !NVIC::is_enabled(Interrupt::USBCTRL_IRQ);
    if waits || uart().uartfr().read().rxfe().bit_is_clear() {
        serial::receive();
    }
}

/// Takes the received bytes of USB and of the UART, which ends the interrupts of both.
///
/// If the queue has no room for a USB packet, the packet stays in the device, and the host waits.
/// Until then its interrupt would repeat without end, so it is masked. The UART's interrupt, which
/// comes with each frame, polls USB instead. The same is done if USB cannot dispose of a packet, or
/// if a reset of the bus does not end.
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

pub(super) fn enable_interrupts() {
    [Interrupt::UART0_IRQ, Interrupt::USBCTRL_IRQ]
        .into_iter()
        .for_each(unmask);
}
