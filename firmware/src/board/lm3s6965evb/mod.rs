//! Stellaris LM3S6965 evaluation board: a Cortex-M3 at 50 MHz, a 128 x 64 OLED panel, five buttons
//! and a serial port.
//!
//! Source: LM3S6965 data sheet; the wiring of the board, as in QEMU's `lm3s6965evb`.
//!
//! | part | pins |
//! |---|---|
//! | panel | SSI0: PA2 clock, PA3 select, PA5 data; PC7 data/command |
//! | memory card, unused | PD0 select, kept high |
//! | buttons | PE0 up, PE1 down, PE2 left, PE3 right, PF1 select; pressed reads 0 |
//! | serial link | UART0: PA0 in, PA1 out |

mod pins;
mod system;

use cortex_m::Peripherals;
use embedded_hal::digital::OutputPin;

use crate::app::{Buttons, Pressed};
use crate::board::Board;
use crate::board::cortex_m::interrupt::{Interrupt, unmask};
use crate::board::cortex_m::start;
use crate::board::cortex_m::watchdog::TwoStage;
use crate::board::register::{Device, Register};
use crate::board::serial::{Inbox, Outward, receive_by, send};
use crate::config::BAUD;
use crate::display::{Memory, Ssd0323};
use crate::graphics::Format;
use crate::protocol::BoardName;

use pins::{Output, Ssi};

pub const FORMAT: Format = Format::OLED;

pub type Lm3s6965evb = Board<Ssd0323<'static, Ssi, Output>, Outward, Keys, TwoStage>;

/// Sets the board up. The tick and the watchdog run from then on. A panel that does not take its
/// settings is only logged, and stays dark.
pub fn take() -> Option<Lm3s6965evb> {
    let core = Peripherals::take()?;
    let hertz = system::start();
    let instruments = start(core, BoardName::Lm3s6965evb, hertz, system::chip());

    // Deselect the memory card, which shares the panel's bus.
    let Ok(()) = pins::D.use_for_output(1 << 0).set_high();

    pins::E.use_for_input(1 << 0 | 1 << 1 | 1 << 2 | 1 << 3);
    pins::F.use_for_input(1 << 1);

    let link = start_link(hertz);
    let memory = cortex_m::singleton!(: Memory = Memory::UNKNOWN)?;
    let mut panel = Ssd0323::new(Ssi::start(hertz), pins::C.use_for_output(1 << 7), memory);
    if panel.init().is_err() {
        defmt::error!("the panel does not answer");
    }

    Some(Board {
        panel,
        link,
        keys: Keys,
        instruments,
        watchdog: system::start_watchdog(hertz),
        reset_by_watchdog: system::reset_by_watchdog(),
    })
}

/// The buttons at PE0 to PE3 and PF1, each low while pressed.
#[derive(Debug)]
pub struct Keys;

impl Buttons for Keys {
    fn read(&mut self) -> Pressed {
        let [up, down, left, right] =
            [1 << 0, 1 << 1, 1 << 2, 1 << 3].map(|pin| pins::E.are_low(pin));
        Pressed {
            up,
            down,
            left,
            right,
            select: pins::F.are_low(1 << 1),
            ..Pressed::default()
        }
    }
}

// SAFETY: UART0 of the data sheet, chapter 12; without DMA it cannot break memory safety.
const UART0: Device = unsafe { Device::at(0x4000_C000) };
const DATA: Register = UART0.register(0x000);
const RECEIVE_STATUS: Register = UART0.register(0x004);
const FLAGS: Register = UART0.register(0x018);
const DIVISOR: Register = UART0.register(0x024);
const DIVISOR_FRACTION: Register = UART0.register(0x028);
const LINE_CONTROL: Register = UART0.register(0x02c);
const CONTROL: Register = UART0.register(0x030);
const INTERRUPT_MASK: Register = UART0.register(0x038);
const INTERRUPT_CLEAR: Register = UART0.register(0x044);

const OVERRUN: u32 = 1 << 3;
const RECEIVER_EMPTY: u32 = 1 << 4;
const TRANSMITTER_FULL: u32 = 1 << 5;
const EIGHT_BITS_QUEUED: u32 = 0b11 << 5 | 1 << 4;
const ENABLE: u32 = 1 << 9 | 1 << 8 | 1 << 0;
const RECEIVED: u32 = 1 << 6 | 1 << 4;

const INTERRUPT: Interrupt = Interrupt(5);

fn start_link(hertz: u32) -> Outward {
    pins::A.use_for_device(1 << 0 | 1 << 1);
    CONTROL.write(0);
    // The divisor hertz/(16 baud) in 64ths, rounded: 50 MHz / (16 x 460,800) = 6 + 50/64, which is
    // off by 0.005 %.
    let divisor = (4 * hertz + BAUD / 2) / BAUD;
    DIVISOR.write(divisor / 64);
    DIVISOR_FRACTION.write(divisor % 64);
    LINE_CONTROL.write(EIGHT_BITS_QUEUED);
    CONTROL.write(ENABLE);

    receive_by(receive);
    INTERRUPT_MASK.write(RECEIVED);
    unmask(INTERRUPT);
    Outward(|bytes| {
        send(
            bytes,
            || FLAGS.read() & TRANSMITTER_FULL == 0,
            |byte| DATA.write(byte.into()),
        )
    })
}

fn receive(inbox: &mut Inbox) {
    // Clear the interrupt first, so that a byte that comes now interrupts again.
    INTERRUPT_CLEAR.write(RECEIVED);
    while FLAGS.read() & RECEIVER_EMPTY == 0 {
        inbox.push(DATA.read() as u8);
    }
    if RECEIVE_STATUS.read() & OVERRUN != 0 {
        RECEIVE_STATUS.write(0); // Any write clears it.
        inbox.note_overrun(true);
    }
}
