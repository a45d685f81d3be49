//! Raspberry Pi Pico: an RP2040 with a Cortex-M0+ at 125 MHz, a panel, buttons, and the serial link
//! over USB and UART0 at once. The second core is not used. The panel is a one-colour OLED or, if
//! the build variable `PANEL` names one, a colour panel that plugs on ([`PanelName`]).
//!
//! A host that opens the USB port at 1200 baud and closes it again restarts the chip in its boot
//! loader.
//!
//! Source: RP2040 data sheet, for the watchdog 2.8 (boot sequence), 2.13 (its resets), 2.14
//! (subsystem resets), 4.7; Raspberry Pi Pico data sheet, for the pins.
//!
//! | part | GPIO |
//! |---|---|
//! | OLED | I2C0: 4 data, 5 clock; address 0x3C or 0x3D |
//! | buttons with an OLED | 10 up, 11 down, 12 left, 13 right, 14 select; each pulls low |
//! | Waveshare panel | SPI1: 10 clock, 11 data; 9 select, 8 data/command, 12 reset, 13 light |
//! | keys of Pico-LCD-1.3 | 2 up, 18 down, 16 left, 20 right, 3 press; 15 A, 17 B, 19 X, 21 Y |
//! | keys of Pico-LCD-2 | 15, 17, 2, 3 as A, B, X, Y |
//! | Pimoroni panel | SPI0: 18 clock, 19 data; 17 select, 16 data/command, 20 light |
//! | keys of Pimoroni | 12 A, 13 B, 14 X, 15 Y |
//! | serial link | UART0: 0 out, 1 in; and the USB socket |

#[cfg(not(lcd))]
mod i2c;
#[cfg(lcd)]
mod lcd;
mod link;
mod pins;
mod usb;

use rp2040_hal::clocks::{Clock, init_clocks_and_plls};
use rp2040_hal::fugit::ExtU32;
use rp2040_hal::gpio::Pins;
use rp2040_hal::watchdog::{ScratchRegister, Watchdog};
use rp2040_hal::{Sio, pac};

use crate::app::{Buttons, Pressed};
use crate::board::cortex_m::{start, watchdog};
use crate::board::serial::Outward;
use crate::board::{Board, log};
use crate::config::WATCHDOG_SECONDS;
use crate::graphics::{Format, PANEL, PanelName};
use crate::protocol::BoardName;

/// The code that the chip's boot ROM runs first. It makes the flash readable as memory, if that is
/// a W25Q080 or a chip with the same commands.
// SAFETY: the linker puts only this section where the ROM expects it.
#[unsafe(link_section = ".boot2")]
#[used]
static BOOT: [u8; 256] = rp2040_boot2::BOOT_LOADER_W25Q080;

/// The Pico's crystal, Hz.
const CRYSTAL: u32 = 12_000_000;

/// The format of the panel.
pub const FORMAT: Format = PANEL.format();

#[cfg(not(lcd))]
type Panel = crate::display::OledI2c<'static, crate::board::panel_bus::Bus<i2c::I2c0>>;
#[cfg(lcd)]
type Panel = crate::display::St7789<lcd::Lcd>;

/// The parts of this board. The watchdog, a type of `rp2040_hal`, has no interrupt: it resets the
/// board 2 s after the last feeding.
pub type Pico = Board<Panel, Outward, PinKeys, Watchdog>;

/// Sets the board up. The tick and the watchdog run from then on, and the watchdog must be fed. The
/// panel and the buttons may be absent. The log is opened first, in memory.
///
/// Returns `None` the second time, if other code has taken the peripherals, or if the settings of
/// the clocks, the UART or USB are refused; then the watchdog is not started. Waits for the crystal
/// and the PLLs, for ever if they do not start, and 12 ms for a host to notice that USB was
/// disconnected.
pub fn take() -> Option<Pico> {
    let core = cortex_m::Peripherals::take()?;
    let mut chip = pac::Peripherals::take()?;

    // The cause of the reset must be read before the clocks are set up.
    log::into_memory();
    let reset_by_watchdog = reset_by_watchdog(&chip.WATCHDOG, &chip.RESETS);
    let mut unit = Watchdog::new(chip.WATCHDOG);
    let clocks = init_clocks_and_plls(
        CRYSTAL,
        chip.XOSC,
        chip.CLOCKS,
        chip.PLL_SYS,
        chip.PLL_USB,
        &mut chip.RESETS,
        &mut unit,
    )
    .ok()?;

    let chip_number = [chip.SYSINFO.chip_id().read().bits(), 0, 0, 0];
    let instruments = start(
        core,
        BoardName::Pico,
        clocks.system_clock.freq().to_Hz(),
        chip_number,
    );

    // The serial link, at UART0 and at the USB socket.
    let pins = Pins::new(
        chip.IO_BANK0,
        chip.PADS_BANK0,
        Sio::new(chip.SIO).gpio_bank0,
        &mut chip.RESETS,
    );
    let serial = (pins.gpio0.reconfigure(), pins.gpio1.reconfigure());
    let link = link::start(
        chip.UART0,
        serial,
        clocks.peripheral_clock.freq(),
        &mut chip.RESETS,
    )?;
    usb::start(
        chip.USBCTRL_REGS,
        chip.USBCTRL_DPRAM,
        clocks.usb_clock,
        &mut chip.RESETS,
    )?;
    link::enable_interrupts();

    // The panel.
    #[cfg(not(lcd))]
    let panel = {
        let wires = (pins.gpio4.reconfigure(), pins.gpio5.reconfigure());
        let bus = i2c::start(chip.I2C0, wires)?;
        let memory =
            cortex_m::singleton!(: crate::graphics::Bitmap = crate::graphics::Bitmap::BLACK)?;
        Panel::new(bus, memory, crate::display::BUILT_FOR)
    };
    #[cfg(lcd)]
    let panel = {
        let lines = cortex_m::singleton!(: lcd::Lines = [[0; 320]; 2])?;
        Panel::new(lcd::Lcd::start(&mut chip.RESETS, lines), PANEL)
    };
    defmt::info!("built for the panel {=str}", PANEL.name());

    // The panel and the buttons may be absent: an open pin reads as high.
    KEYS.iter().flatten().copied().for_each(pins::use_for_input);
    Some(Board {
        panel,
        link,
        keys: PinKeys,
        instruments,
        watchdog: start_watchdog(unit),
        reset_by_watchdog,
    })
}

/// The pins of up, down, left, right and select, then of A, B, X and Y.
const KEYS: [Option<usize>; 9] = match PANEL {
    PanelName::Oled => keys([10, 11, 12, 13, 14], [NONE; 4]),
    PanelName::Lcd13 => keys([2, 18, 16, 20, 3], [15, 17, 19, 21]),
    PanelName::Lcd2 => keys([NONE; 5], [15, 17, 2, 3]),
    PanelName::Display | PanelName::Display2 => keys([NONE; 5], [12, 13, 14, 15]),
};
/// No pin.
const NONE: usize = usize::MAX;

const fn keys(arrows: [usize; 5], letters: [usize; 4]) -> [Option<usize>; 9] {
    let mut keys = [None; 9];
    let mut place = 0;
    while place < 9 {
        let pin = if place < 5 {
            arrows[place]
        } else {
            letters[place - 5]
        };
        if pin != NONE {
            keys[place] = Some(pin);
        }
        place += 1;
    }
    keys
}

/// The buttons, each low while pressed. Absent ones are never pressed, and with an OLED select
/// alone is sufficient.
pub struct PinKeys;

impl Buttons for PinKeys {
    fn read(&mut self) -> Pressed {
        let [up, down, left, right, select, a, b, x, y] =
            KEYS.map(|pin| pin.is_some_and(pins::is_low));
        Pressed {
            up,
            down,
            left,
            right,
            select,
            letters: [a, b, x, y],
        }
    }
}

/// The number that the SDK's `watchdog_enable` writes into a scratch register. A reset does not
/// change it, but programs that use the watchdog for a planned restart overwrite it.
const STARTED: u32 = 0x6ab7_3121;

/// Returns true if the watchdog caused the last reset. Call it before any subsystem is taken out of
/// reset: the watchdog resets all subsystems, a debugger does not.
///
/// The watchdog's register REASON alone is not sufficient. The boot ROM resets the chip by the same
/// watchdog after each download. A debugger's reset, which resets only the processor (SYSRESETREQ),
/// leaves REASON unchanged.
fn reset_by_watchdog(unit: &pac::WATCHDOG, resets: &pac::RESETS) -> bool {
    unit.reason().read().timer().bit_is_set()
        && unit.scratch4().read().bits() == STARTED
        && resets.reset().read().i2c0().bit_is_set()
}

/// Starts the watchdog, which has no interrupt: it resets the board after twice
/// [`WATCHDOG_SECONDS`] without a feeding. The set-up of the clocks uses it before, because it also
/// generates the chip's microseconds.
fn start_watchdog(mut unit: Watchdog) -> Watchdog {
    unit.write_scratch(ScratchRegister::Scratch4, STARTED);
    unit.start((2 * WATCHDOG_SECONDS).secs());
    watchdog::stall_by(|stalls| {
        // SAFETY: the support library uses other bits of this register, and only before this.
        let unit = unsafe { &*pac::WATCHDOG::ptr() };
        unit.ctrl().modify(|_, w| {
            w.pause_dbg0()
                .bit(stalls)
                .pause_dbg1()
                .bit(stalls)
                .pause_jtag()
                .bit(stalls)
        });
    });
    unit
}

impl watchdog::Watchdog for Watchdog {
    fn feed(&mut self) {
        Self::feed(self);
    }
}
