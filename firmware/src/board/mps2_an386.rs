//! ARM MPS2 with image AN386: a Cortex-M4F at 25 MHz, with a serial port only.
//!
//! Source: ARM DAI 0386; the serial port is the CMSDK UART of ARM DDI 0479.

use cortex_m::Peripherals;

use super::Board;
use super::cortex_m::interrupt::{Interrupt, unmask};
use super::cortex_m::start;
use super::cortex_m::watchdog::{NMI, TwoStage};
use super::register::{Device, Register};
use super::serial::{Inbox, Outward, receive_by, send};
use crate::app::NoButtons;
use crate::config::BAUD;
use crate::display::NoDisplay;
use crate::protocol::BoardName;

/// The processor's clock, Hz.
const HERTZ: u32 = 25_000_000;

// SAFETY: UART0; without DMA it cannot break memory safety.
const UART0: Device = unsafe { Device::at(0x4000_4000) };
const DATA: Register = UART0.register(0x000);
const STATE: Register = UART0.register(0x004);
const CONTROL: Register = UART0.register(0x008);
const INTERRUPT_CLEAR: Register = UART0.register(0x00c);
const DIVISOR: Register = UART0.register(0x010);

/// The watchdog of ARM DDI 0479. Its interrupt is the NMI. No register indicates a reset.
// SAFETY: without DMA it cannot break memory safety.
const WATCHDOG: Device = unsafe { Device::at(0x4000_8000) };

const TRANSMITTER_FULL: u32 = 1 << 0;
const RECEIVER_FULL: u32 = 1 << 1;
const RECEIVER_OVERRUN: u32 = 1 << 3;
/// The transmitter, the receiver and the receiver's interrupt are on.
const ENABLE: u32 = 1 << 3 | 1 << 1 | 1 << 0;
const RECEIVED: u32 = 1 << 1;

/// The interrupt of UART0's receiver.
const INTERRUPT: Interrupt = Interrupt(0);

/// The parts of this board.
pub type Mps2An386 = Board<NoDisplay, Outward, NoButtons, TwoStage>;

/// Sets the board up. The tick and the watchdog run from then on, and the watchdog must be fed. No
/// register indicates a reset by the watchdog, so `reset_by_watchdog` is always false. The log goes
/// to the debugger, and needs no set-up.
///
/// Returns `None` the second time, or if other code has taken the processor's peripherals.
pub fn take() -> Option<Mps2An386> {
    let instruments = start(Peripherals::take()?, BoardName::Mps2An386, HERTZ, [0; 4]);

    // The serial link.
    receive_by(receive);
    DIVISOR.write(HERTZ / BAUD);
    CONTROL.write(ENABLE);
    unmask(INTERRUPT);
    Some(Board {
        panel: NoDisplay,
        link: Outward(|bytes| {
            send(
                bytes,
                || STATE.read() & TRANSMITTER_FULL == 0,
                |byte| DATA.write(byte.into()),
            )
        }),
        keys: NoButtons,
        instruments,
        watchdog: TwoStage::start(WATCHDOG, HERTZ, NMI),
        reset_by_watchdog: false,
    })
}

/// Takes the received bytes.
fn receive(inbox: &mut Inbox) {
    INTERRUPT_CLEAR.write(RECEIVED);
    while STATE.read() & RECEIVER_FULL != 0 {
        inbox.push(DATA.read() as u8);
    }
    if STATE.read() & RECEIVER_OVERRUN != 0 {
        STATE.write(RECEIVER_OVERRUN); // Writing the bit clears it.
        inbox.note_overrun(true);
    }
}
