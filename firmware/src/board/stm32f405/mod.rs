//! STM32F405 (or F407): a Cortex-M4F at 168 MHz, a one-colour OLED panel on I2C1, one button, and a
//! serial port at USART3.
//!
//! The same image runs on the chip and in QEMU's `netduinoplus2`. That machine has the processor,
//! the memory and the serial ports, but neither clock control nor pins nor I2C. Their registers
//! read 0 and ignore writes.
//!
//! Source: ST RM0090, reference manual of the STM32F405 and F407; pins as on the Adafruit Feather
//! STM32F405 Express.
//!
//! | part | pins |
//! |---|---|
//! | panel | I2C1: PB6 clock, PB7 data; address 0x3C or 0x3D |
//! | button | PC7, pulls low |
//! | serial link | USART3: PB10 out, PB11 in |

mod i2c;

use stm32f4xx_hal::gpio::{PB10, PB11, PC7, Pull};
use stm32f4xx_hal::pac::usart1::RegisterBlock;
use stm32f4xx_hal::pac::{self, DBGMCU, IWDG, Interrupt, RCC, USART3};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Rcc};
use stm32f4xx_hal::serial::{Event, config};
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use crate::app::{Buttons, Pressed};
use crate::board::cortex_m::interrupt::unmask;
use crate::board::cortex_m::start;
use crate::board::cortex_m::watchdog::{self, Watchdog};
use crate::board::panel_bus::Bus;
use crate::board::serial::{Inbox, Outward, receive_by, send};
use crate::board::{Board, log};
use crate::config::{BAUD, WATCHDOG_SECONDS};
use crate::display::{BUILT_FOR, OledI2c};
use crate::graphics::{Bitmap, Format};
use crate::protocol::BoardName;

use i2c::I2c1;

const HERTZ: u32 = 168_000_000;

/// The address of the chip's unique number (RM0090, 39.1), in its system memory.
const UNIQUE_NUMBER: *const [u32; 3] = core::ptr::without_provenance(0x1fff_7a10);

pub const FORMAT: Format = Format::OLED;

pub type Stm32f405 = Board<OledI2c<'static, Bus<I2c1>>, Outward, OneKey, IndependentWatchdog>;

/// Sets the board up. The emulator has no watchdog. A chip whose own oscillator reads as not ready
/// counts as emulated: its log goes to the emulator, and its number is zeros.
pub fn take() -> Option<Stm32f405> {
    let core = cortex_m::Peripherals::take()?;
    let chip = pac::Peripherals::take()?;
    let (mut rcc, is_emulated) = start_clock(chip.RCC);
    // The emulator needs the log on its standard output; a chip needs a place for the probe to
    // read.
    if is_emulated {
        log::into_emulator()
    } else {
        log::into_memory();
        keep_log_readable();
    }

    let chip_number = if is_emulated { [0; 4] } else { chip_number() };
    let instruments = start(core, BoardName::Stm32f405, HERTZ, chip_number);

    let b = chip.GPIOB.split(&mut rcc);
    let c = chip.GPIOC.split(&mut rcc);
    let bus = i2c::start(chip.I2C1, b.pb6, b.pb7, &mut rcc)?;
    let memory = cortex_m::singleton!(: Bitmap = Bitmap::BLACK)?;
    Some(Board {
        panel: OledI2c::new(bus, memory, BUILT_FOR),
        link: start_link(chip.USART3, (b.pb10, b.pb11), &mut rcc)?,
        keys: OneKey(c.pc7.into_pull_up_input()),
        instruments,
        watchdog: start_watchdog(chip.IWDG),
        reset_by_watchdog: reset_by_watchdog(&mut rcc),
    })
}

/// The only button, which is the select button, low while pressed.
pub struct OneKey(PC7);

impl Buttons for OneKey {
    fn read(&mut self) -> Pressed {
        Pressed {
            select: self.0.is_low(),
            ..Pressed::default()
        }
    }
}

/// Keeps the clock of the memory on while the processor sleeps, as it does between frames.
/// Otherwise a probe reads zeros there, and finds no log.
///
/// `probe-rs` sets these bits itself; OpenOCD and J-Link leave it to a script (RM0090, 38.16.3:
/// DBGMCU_CR).
fn keep_log_readable() {
    // SAFETY: no other code uses this register, and its bits affect only debugging.
    let debug = unsafe { &*DBGMCU::ptr() };
    debug
        .cr()
        .modify(|_, w| w.dbg_sleep().set_bit().dbg_stop().set_bit());
}

fn chip_number() -> [u32; 4] {
    // SAFETY: both are only read, and no other code uses them.
    let (debug, unique) = unsafe { (&*DBGMCU::ptr(), &*UNIQUE_NUMBER) };
    let [a, b, c] = *unique;
    [debug.idcode().read().bits(), a, b, c]
}

/// Starts the clocks of the processor and the buses. The second value is true in an emulator.
///
/// The source is the chip's own oscillator. It is accurate to 1 % at room temperature, which is
/// sufficient for the eye and for the serial port. So the image fits boards with any crystal (8, 12
/// and 25 MHz are in use), and no crystal can fail to start.
fn start_clock(rcc: RCC) -> (Rcc, bool) {
    // After reset a chip runs from this oscillator.
    if rcc.cr().read().hsirdy().bit_is_set() {
        (rcc.freeze(Config::hsi().sysclk(HERTZ.Hz())), false)
    } else {
        // The emulator has no PLL to wait for, either.
        (rcc.freeze(Config::hsi()), true)
    }
}

fn start_link(port: USART3, pins: (PB10, PB11), rcc: &mut Rcc) -> Option<Outward> {
    // The adapter is optional. Without it the input would float next to the output, and receive an
    // echo of it. The library does not set the pull-up (RM0090, 8.4.4).
    let pins = (pins.0, pins.1.internal_resistor(Pull::Up));

    // Both clocks have a divisor for this baud rate, so that this does not fail.
    let mut port = port
        .serial::<u8>(pins, config::Config::default().baudrate(BAUD.bps()), rcc)
        .ok()?;
    port.listen(Event::RxNotEmpty);
    receive_by(receive);
    unmask(Interrupt::USART3);
    Some(Outward(|bytes| {
        send(bytes, || uart().sr().read().txe().bit_is_set(), put)
    }))
}

fn put(byte: u8) {
    uart().dr().write(|w| w.dr().set(byte.into()));
}

fn uart() -> &'static RegisterBlock {
    // SAFETY: the two directions use different bits of these registers, and reading does not change
    // the bits of the other one.
    unsafe { &*USART3::ptr() }
}

/// Reading a byte ends its interrupt. A byte that comes before the last one was read is lost, and
/// the overrun interrupts until the data are read.
fn receive(inbox: &mut Inbox) {
    loop {
        let status = uart().sr().read();
        let has_byte = status.rxne().bit_is_set();
        let overrun = status.ore().bit_is_set();
        if !has_byte && !overrun {
            return;
        }
        let byte = uart().dr().read().dr().bits() as u8;
        inbox.note_overrun(overrun);
        if has_byte {
            inbox.push(byte);
        }
    }
}

/// Starts the independent watchdog, which has no interrupt: it resets the board after twice
/// [`WATCHDOG_SECONDS`] without a feeding. Its own oscillator is accurate to a factor of 2 (17 to
/// 47 kHz instead of 32). The emulator has no such watchdog.
fn start_watchdog(unit: IWDG) -> IndependentWatchdog {
    let mut unit = IndependentWatchdog::new(unit);
    watchdog::stall_by(|stalls| {
        // SAFETY: no other code uses this register.
        let debug = unsafe { &*DBGMCU::ptr() };
        debug.apb1_fz().modify(|_, w| w.dbg_iwdg_stop().bit(stalls));
    });
    unit.start((2 * 1000 * WATCHDOG_SECONDS).millis());
    unit
}

/// Returns true if the watchdog caused the last reset. It clears the cause.
fn reset_by_watchdog(rcc: &mut Rcc) -> bool {
    let has_reset = rcc.csr().read().wdgrstf().bit_is_set();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    has_reset
}

impl Watchdog for IndependentWatchdog {
    fn feed(&mut self) {
        Self::feed(self);
    }
}
