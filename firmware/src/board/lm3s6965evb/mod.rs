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

mod buttons;
mod gpio;
mod ssi;
mod system;
mod uart;
mod watchdog;

use cortex_m::Peripherals;
use embedded_hal::digital::OutputPin;

use crate::board::Board;
use crate::board::cortex_m::clock::Clock;
use crate::board::cortex_m::guard::guard_stack;
use crate::board::cortex_m::identity::instruments;
use crate::board::cortex_m::watchdog::TwoStage;
use crate::board::serial::receiver::Receiver;
use crate::board::serial::transmitter::Transmitter;
use crate::display::Ssd0323;
use crate::graphics::Canvas;
use crate::protocol::BoardName;

use buttons::Keys;
use gpio::Output;
use ssi::Ssi;
use uart::Pl011;

pub type Lm3s6965evb = Board<Ssd0323<'static, Ssi, Output>, Transmitter<Pl011>, Keys, TwoStage>;

/// Sets the board up; `None` the second time.
pub fn take() -> Option<Lm3s6965evb> {
    let core = Peripherals::take()?;
    guard_stack(core.MPU);
    let hertz = system::start();
    let Ok(()) = gpio::card_select().set_high();
    let link = uart::start(hertz);
    let receiver = Receiver::new(uart::INLET)?;
    uart::enable_receiver();
    let memory = cortex_m::singleton!(: Canvas = Canvas::BLACK)?;
    let mut panel = Ssd0323::new(Ssi::start(hertz), gpio::data_not_command(), memory);
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
        watchdog: watchdog::start(hertz),
        reset_by_watchdog: system::reset_by_watchdog(),
    })
}
