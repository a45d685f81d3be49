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

/// The bus's clock, Hz.
const SPEED: u32 = 400_000;
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
    // SAFETY: the field takes this number.
    registers()
        .ic_tx_tl()
        .write(|w| unsafe { w.tx_tl().bits(FEW) });
    let bus = Bus::new(I2c0(()))?;
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
    if outbox.is_empty() {
        if !status.stop_det().is_active() {
            return None;
        }
        // It may be that of a message before.
        let _ = port.ic_clr_stop_det().read();
        let (status, asks) = (port.ic_status().read(), outbox.asks);
        return (status.tfe().is_empty() && (!asks || status.rfne().is_not_empty())).then(|| {
            if asks {
                outbox.status = port.ic_data_cmd().read().dat().bits();
            }
            listen(port, NOTHING);
            Ok(())
        });
    }
    while port.ic_status().read().tfnf().is_not_full()
        && let Some(byte) = outbox.next()
    {
        // SAFETY: any byte may be sent.
        port.ic_data_cmd()
            .write(|w| unsafe { w.dat().bits(byte.value).stop().bit(byte.ends_message) });
    }
    if outbox.is_empty() {
        if outbox.asks {
            // There is room: the message before it is a short one.
            port.ic_data_cmd().write(|w| w.cmd().read().stop().enable());
        }
        // What is left to wait for is the last stop.
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
