//! The I2C bus of the panel: bytes are sent by the bus's interrupt, 16 at a time.
//!
//! Source: RP2040 data sheet, 4.3.

use cortex_m::asm::delay;
use embedded_hal::i2c::ErrorKind;
use rp2040_hal::I2C;
use rp2040_hal::fugit::{HertzU32, RateExtU32};
use rp2040_hal::gpio::bank0::{Gpio4, Gpio5};
use rp2040_hal::gpio::{FunctionI2C, Pin, PullUp};
use rp2040_hal::pac::i2c0::RegisterBlock;
use rp2040_hal::pac::io_bank0::GPIO;
use rp2040_hal::pac::{I2C0, IO_BANK0, Interrupt, RESETS, interrupt};

use crate::board::cortex_m::interrupt::unmask;
use crate::board::panel_bus::{self, Bus, PanelPort, TRIES};
use crate::display::{Outbox, SILENCE, Sent, free_bus};

/// The frequency that the support library sets the bus up for, Hz: fast mode, whose hold times it
/// takes. The clock itself is set by [`LOW_COUNT`] and [`HIGH_COUNT`].
const SPEED: u32 = 400_000;
/// The processor's clock, which the bus counts, cycles per us.
const MEGAHERTZ: u32 = 125;
/// The registers of the bus's clock, in cycles, and the longest spike that is suppressed.
///
/// The support library's values leave out what the block adds to them, and give 330 to 376 kHz.
const LOW_COUNT: u16 = 175;
const HIGH_COUNT: u16 = 108;
const SPIKE: u8 = 11;
/// Cycles for which the clock is low, and those from its rise to its fall.
///
/// Source: RP2040 data sheet, 4.3.14 (the block adds 1 and SPKLEN + 7).
const LOW: u32 = LOW_COUNT as u32 + 1;
const HIGH: u32 = HIGH_COUNT as u32 + SPIKE as u32 + 7;

/// Returns the frequency of the bus, Hz, with a line that rises in so many ns.
const fn hertz(rise: u32) -> u32 {
    let cycles_of_1000 = 1000 * (LOW + HIGH) + MEGAHERTZ * rise;
    (1_000_000_000 / cycles_of_1000) * MEGAHERTZ
}
/// NXP UM10204, table 10: at least 1.3 us low and 0.6 us high; the SSD1306 wants 2.5 us in all.
const _: () = assert!(1000 * LOW / MEGAHERTZ >= 1300);
const _: () = assert!(1000 * HIGH / MEGAHERTZ >= 600);
/// With the 0.2 us of 4.7 kOhm and 50 pF.
const _: () = assert!(hertz(200) >= 380_000 && hertz(200) <= 400_000);
/// With the 0.1 us of 2.2 kOhm.
const _: () = assert!(hertz(100) <= 400_000);

/// Bytes left when the next are fetched: 90 us before the last is sent.
const FEW: u8 = 4;
/// Half a clock of a slow 100 kHz, cycles of 125 MHz.
const HALF_CLOCK: u32 = 625;

const NOTHING: u32 = 0;
const FEW_LEFT: u32 = 1 << 4;
const ABORTED: u32 = 1 << 6;
const STOPPED: u32 = 1 << 9;

/// Why it aborted: an address or a byte was not acknowledged.
const REFUSED: u32 = 1 << 3 | 1 << 0;
/// Another master had the bus.
const LOST: u32 = 1 << 12;

/// The GPIO of the bus's lines.
const DATA: usize = 4;
const CLOCK: usize = 5;

pub struct I2c0(());

/// The pins 4 and 5 of the bus.
pub(super) type Pins = (
    Pin<Gpio4, FunctionI2C, PullUp>,
    Pin<Gpio5, FunctionI2C, PullUp>,
);

/// Starts it from this clock; `None` the second time. The support library sets it up and lets go of it.
pub(super) fn start(
    port: I2C0,
    pins: Pins,
    clock: HertzU32,
    resets: &mut RESETS,
) -> Option<Bus<I2c0>> {
    I2C::i2c0(port, pins.0, pins.1, SPEED.Hz(), resets, clock);
    let block = registers();
    // SAFETY: the fields take these numbers. The block takes them only while it is disabled; its
    // next transfer enables it.
    unsafe {
        block.ic_tx_tl().write(|w| w.tx_tl().bits(FEW));
        block.ic_enable().write(|w| w.enable().disabled());
        block
            .ic_fs_scl_lcnt()
            .write(|w| w.ic_fs_scl_lcnt().bits(LOW_COUNT));
        block
            .ic_fs_scl_hcnt()
            .write(|w| w.ic_fs_scl_hcnt().bits(HIGH_COUNT));
        block.ic_fs_spklen().write(|w| w.ic_fs_spklen().bits(SPIKE));
    }
    let bus = Bus::new(I2c0(()), clock.to_Hz())?;
    unmask(Interrupt::I2C0_IRQ);
    Some(bus)
}

impl PanelPort for I2c0 {
    fn begin(&mut self, address: u8) {
        let port = registers();
        // The last stop may still be under way.
        let _ = (0..TRIES).any(|_| port.ic_status().read().mst_activity().is_idle());
        port.ic_enable().write(|w| w.enable().disabled());
        // SAFETY: an address of seven bits.
        port.ic_tar()
            .write(|w| unsafe { w.ic_tar().bits(address.into()) });
        port.ic_enable().write(|w| w.enable().enabled());
        listen(port, FEW_LEFT | ABORTED);
    }

    fn reset(&mut self) {
        listen(registers(), NOTHING);
        registers().ic_enable().write(|w| w.enable().disabled());
        free_bus(|clock, data| {
            drive(CLOCK, clock);
            drive(DATA, data);
            delay(HALF_CLOCK);
            pin(DATA).gpio_status().read().infrompad().bit_is_set()
        });
        for line in [DATA, CLOCK] {
            pin(line)
                .gpio_ctrl()
                .modify(|_, w| w.oeover().normal().outover().normal());
        }
    }
}

#[interrupt]
fn I2C0_IRQ() {
    panel_bus::serve(|outbox| advance(registers(), outbox));
}

fn registers() -> &'static RegisterBlock {
    // SAFETY: the support library has let go of them; while there is something in the outbox the bus is the interrupt's.
    unsafe { &*I2C0::ptr() }
}

/// Does what the bus waits for: more bytes, or at the end nothing more. After the last byte of a message it makes a stop.
fn advance(port: &RegisterBlock, outbox: &mut Outbox) -> Option<Sent> {
    let status = port.ic_raw_intr_stat().read();
    if status.tx_abrt().is_active() {
        let reason = port.ic_tx_abrt_source().read().bits();
        let _ = port.ic_clr_tx_abrt().read();
        listen(port, NOTHING);
        return Some(Err(match reason {
            _ if reason & REFUSED != 0 => SILENCE,
            _ if reason & LOST != 0 => ErrorKind::ArbitrationLoss,
            _ => ErrorKind::Other,
        }));
    }
    if outbox.is_empty() && outbox.requested == outbox.asked() {
        if !status.stop_det().is_active() {
            return None;
        }
        // It may be that of a message before.
        let _ = port.ic_clr_stop_det().read();
        let is_sent = port.ic_status().read().tfe().is_empty();
        let is_read = usize::from(port.ic_rxflr().read().rxflr().bits()) >= outbox.asked();
        if !is_sent || !is_read {
            return None;
        }
        for _ in 0..outbox.asked() {
            outbox.answer(port.ic_data_cmd().read().dat().bits());
        }
        listen(port, NOTHING);
        return Some(Ok(()));
    }

    while port.ic_status().read().tfnf().is_not_full() {
        if let Some(byte) = outbox.next() {
            // SAFETY: any byte may be sent.
            port.ic_data_cmd()
                .write(|w| unsafe { w.dat().bits(byte.value).stop().bit(byte.ends_message) });
        } else if outbox.requested < outbox.asked() {
            outbox.requested += 1;
            let is_last = outbox.requested == outbox.asked();
            port.ic_data_cmd()
                .write(|w| w.cmd().read().stop().bit(is_last));
        } else {
            break;
        }
    }
    if outbox.is_empty() && outbox.requested == outbox.asked() {
        // Only the last stop is still to come.
        let _ = port.ic_clr_stop_det().read();
        listen(port, STOPPED | ABORTED);
    }
    None
}

fn listen(port: &RegisterBlock, to: u32) {
    // SAFETY: a bit for each interrupt.
    port.ic_intr_mask().write(|w| unsafe { w.bits(to) });
}

fn pin(number: usize) -> &'static GPIO {
    // SAFETY: nothing else uses the registers of these pins.
    unsafe { &*IO_BANK0::ptr() }.gpio(number)
}

/// Lets a line go, or pulls it low, whatever the bus does with it.
fn drive(number: usize, high: bool) {
    pin(number).gpio_ctrl().modify(|_, w| {
        if high {
            w.oeover().disable()
        } else {
            w.outover().low().oeover().enable()
        }
    });
}
