//! Stellaris LM3S6965 evaluation board: Cortex-M3 at 50 MHz, 128 x 64 OLED panel, five buttons, a serial port.
//!
//! Source: LM3S6965 data sheet; the wiring is that of the board, which QEMU's `lm3s6965evb` follows.
//!
//! | part | pins |
//! |---|---|
//! | panel | SSI0: PA2 clock, PA3 select, PA5 data; PC7 data/command |
//! | memory card, unused | PD0 select, kept high |
//! | buttons | PE0 up, PE1 down, PE2 left, PE3 right, PF1 select; pressed reads 0 |
//! | serial link | UART0: PA0 in, PA1 out |

mod gpio;
mod ssi;
mod system;

use cortex_m::Peripherals;
use embedded_hal::digital::OutputPin;

use crate::app::{Buttons, Pressed};
use crate::board::Board;
use crate::board::cortex_m::interrupt::Interrupt;
use crate::board::cortex_m::watchdog::TwoStage;
use crate::board::cortex_m::{Clock, guard_stack, instruments};
use crate::board::register::{Device, Register};
use crate::board::serial::{self, Inward, Receiver, Taken, Transmitter};
use crate::config::BAUD;
use crate::display::Ssd0323;
use crate::graphics::Canvas;
use crate::protocol::BoardName;

use gpio::Output;
use ssi::Ssi;

pub type Lm3s6965evb = Board<Ssd0323<'static, Ssi, Output>, Transmitter, Keys, TwoStage>;

/// Sets the board up; `None` the second time.
pub fn take() -> Option<Lm3s6965evb> {
    let core = Peripherals::take()?;
    guard_stack(core.MPU);
    let hertz = system::start();
    // The memory card shares the panel's bus.
    let Ok(()) = gpio::D.use_for_output(1 << 0).set_high();
    let (link, receiver) = start_link(hertz);
    let memory = cortex_m::singleton!(: Canvas = Canvas::BLACK)?;
    let mut panel = Ssd0323::new(Ssi::start(hertz), gpio::C.use_for_output(1 << 7), memory);
    if panel.init().is_err() {
        defmt::error!("the panel does not answer");
    }
    Some(Board {
        panel,
        link,
        receiver,
        keys: Keys::start(),
        instruments: instruments(BoardName::Lm3s6965evb, hertz, system::chip(), &core.CPUID, core.DCB, core.DWT),
        clock: Clock::start(core.SYST, hertz),
        watchdog: system::start_watchdog(hertz),
        reset_by_watchdog: system::reset_by_watchdog(),
    })
}

const UP: u8 = 1 << 0;
const DOWN: u8 = 1 << 1;
const LEFT: u8 = 1 << 2;
const RIGHT: u8 = 1 << 3;
const SELECT: u8 = 1 << 1;

/// PE0 to PE3 and PF1, each low while pressed.
#[derive(Debug)]
pub struct Keys(());

impl Keys {
    pub(super) fn start() -> Self {
        gpio::E.use_for_input(UP | DOWN | LEFT | RIGHT);
        gpio::F.use_for_input(SELECT);
        Self(())
    }
}

impl Buttons for Keys {
    fn read(&mut self) -> Pressed {
        let low = !gpio::E.read(UP | DOWN | LEFT | RIGHT);
        Pressed {
            up: low & UP != 0,
            down: low & DOWN != 0,
            left: low & LEFT != 0,
            right: low & RIGHT != 0,
            select: !gpio::F.read(SELECT) & SELECT != 0,
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

/// Starts the serial port (PL011).
fn start_link(hertz: u32) -> (Transmitter, Receiver) {
    gpio::A.use_for_device(1 << 0 | 1 << 1);
    CONTROL.write(0);
    // The divisor hertz/(16 baud) in 64ths, rounded: 50 MHz / (16 x 460,800) = 6 + 50/64, 0.005 % off.
    let divisor = (4 * hertz + BAUD / 2) / BAUD;
    DIVISOR.write(divisor / 64);
    DIVISOR_FRACTION.write(divisor % 64);
    LINE_CONTROL.write(EIGHT_BITS_QUEUED);
    CONTROL.write(ENABLE);
    let receiver = serial::receive_from(Inward { clear: |_| INTERRUPT_CLEAR.write(RECEIVED), take: received });
    INTERRUPT_MASK.write(RECEIVED);
    INTERRUPT.unmask();
    (Transmitter { is_ready: || FLAGS.read() & TRANSMITTER_FULL == 0, put: |byte| DATA.write(byte.into()) }, receiver)
}

fn received() -> Taken {
    let overrun = RECEIVE_STATUS.read() & OVERRUN != 0;
    if overrun {
        RECEIVE_STATUS.write(0); // Any write clears it.
    }
    Taken { byte: (FLAGS.read() & RECEIVER_EMPTY == 0).then(|| DATA.read() as u8), overrun }
}
