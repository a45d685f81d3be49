//! The I2C bus of the panel: bytes are sent by the bus's interrupt, 16 at a time.
//!
//! Source: RP2040 data sheet, 4.3.

use cortex_m::asm::delay;
use cortex_m::peripheral::NVIC;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use rp2040_hal::gpio::bank0::{Gpio4, Gpio5};
use rp2040_hal::gpio::{FunctionI2C, OutputEnableOverride, OutputOverride, Pin, PinId, PullUp, ValidFunction};
use rp2040_hal::pac::i2c0::RegisterBlock;
use rp2040_hal::pac::{I2C0, Interrupt, RESETS, interrupt};

use crate::board::panel_bus::{self, Bus, PanelPort};
use crate::display::{Outbox, Sent, free_bus};

/// The bus's clock, Hz, and the part of a period that it is low.
const SPEED: u32 = 400_000;
const LOW: (u32, u32) = (3, 5);
/// The data line is held for so long after the clock has fallen: 300 ns.
const HOLD: (u32, u32) = (3, 10_000_000);
/// Bytes left when the next are fetched: 90 us before the last is sent.
const FEW: u8 = 4;
/// How often a stop is waited for, which takes 5 us: these tries take at least 12.
const TRIES: u32 = 500;
/// Half a clock of a slow 100 kHz, cycles of 125 MHz.
const HALF_CLOCK: u32 = 625;

const NOTHING: u32 = 0;
const FEW_LEFT: u32 = 1 << 4;
const ABORTED: u32 = 1 << 6;
const STOPPED: u32 = 1 << 9;

const ADDRESS_REFUSED: u32 = 1 << 0;
const DATA_REFUSED: u32 = 1 << 3;
const ARBITRATION_LOST: u32 = 1 << 12;

pub(super) type Lines = (Line<Gpio4>, Line<Gpio5>);

pub struct I2c0 {
    port: I2C0,
    lines: Lines,
}

/// Starts it from a clock of `hertz`; `None` if the device does not come out of its reset.
pub(super) fn start(
    port: I2C0,
    lines: Lines,
    resets: &mut RESETS,
    hertz: u32,
    outbox: &'static mut Outbox,
) -> Option<Bus<I2c0>> {
    resets.reset().modify(|_, w| w.i2c0().set_bit());
    resets.reset().modify(|_, w| w.i2c0().clear_bit());
    if !(0..TRIES).any(|_| resets.reset_done().read().i2c0().bit_is_set()) {
        return None;
    }
    let period = hertz / SPEED;
    let low = period * LOW.0 / LOW.1;
    port.ic_con().write(|w| {
        w.speed().fast().master_mode().enabled().ic_slave_disable().slave_disabled().ic_restart_en().enabled()
    });
    // SAFETY: the fields take these numbers.
    unsafe {
        port.ic_fs_scl_hcnt().write(|w| w.ic_fs_scl_hcnt().bits((period - low) as u16));
        port.ic_fs_scl_lcnt().write(|w| w.ic_fs_scl_lcnt().bits(low as u16));
        port.ic_fs_spklen().write(|w| w.ic_fs_spklen().bits((low / 16) as u8));
        port.ic_sda_hold().write(|w| w.ic_sda_tx_hold().bits((hertz / HOLD.1 * HOLD.0 + 1) as u16));
        port.ic_tx_tl().write(|w| w.tx_tl().bits(FEW));
    }
    let mut port = I2c0 { port, lines };
    port.reset();
    // SAFETY: no critical section relies on this interrupt being masked.
    unsafe { NVIC::unmask(Interrupt::I2C0_IRQ) };
    Some(Bus::new(port, outbox))
}

impl PanelPort for I2c0 {
    fn begin(&mut self, address: u8) {
        let port = &self.port;
        // The last stop may still be under way.
        let _ = (0..TRIES).any(|_| port.ic_status().read().mst_activity().is_idle());
        port.ic_enable().write(|w| w.enable().disabled());
        // SAFETY: an address of seven bits.
        port.ic_tar().write(|w| unsafe { w.ic_tar().bits(address.into()) });
        port.ic_enable().write(|w| w.enable().enabled());
        listen(port, FEW_LEFT | ABORTED);
    }

    fn reset(&mut self) {
        listen(&self.port, NOTHING);
        self.port.ic_enable().write(|w| w.enable().disabled());
        let (data, clock) = &mut self.lines;
        free_bus(clock, data, || delay(HALF_CLOCK));
        data.release();
        clock.release();
    }
}

#[interrupt]
fn I2C0_IRQ() {
    panel_bus::serve(|outbox| advance(registers(), outbox));
}

fn registers() -> &'static RegisterBlock {
    // SAFETY: while there is something in the outbox the bus is the interrupt's.
    unsafe { &*I2C0::ptr() }
}

/// Does what the bus waits for: more bytes, or at the end nothing more. After the last byte of a message it makes a stop.
fn advance(port: &RegisterBlock, outbox: &mut Outbox) -> Option<Sent> {
    let status = port.ic_raw_intr_stat().read();
    if status.tx_abrt().is_active() {
        let reason = port.ic_tx_abrt_source().read().bits();
        let _ = port.ic_clr_tx_abrt().read();
        listen(port, NOTHING);
        return Some(Err(error(reason)));
    }
    if outbox.is_empty() {
        if !status.stop_det().is_active() {
            return None;
        }
        // It may be that of a message before.
        let _ = port.ic_clr_stop_det().read();
        let (status, asks) = (port.ic_status().read(), outbox.asks());
        return (status.tfe().is_empty() && (!asks || status.rfne().is_not_empty())).then(|| {
            if asks {
                outbox.answer(port.ic_data_cmd().read().dat().bits());
            }
            listen(port, NOTHING);
            Ok(())
        });
    }
    while port.ic_status().read().tfnf().is_not_full()
        && let Some(byte) = outbox.next()
    {
        // SAFETY: any byte may be sent.
        port.ic_data_cmd().write(|w| unsafe { w.dat().bits(byte.value).stop().bit(byte.ends_message) });
    }
    if outbox.is_empty() {
        if outbox.asks() {
            // There is room: the message before it is a short one.
            port.ic_data_cmd().write(|w| w.cmd().read().stop().enable());
        }
        // What is left to wait for is the last stop.
        let _ = port.ic_clr_stop_det().read();
        listen(port, STOPPED | ABORTED);
    }
    None
}

fn error(reason: u32) -> ErrorKind {
    if reason & ADDRESS_REFUSED != 0 {
        ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address)
    } else if reason & DATA_REFUSED != 0 {
        ErrorKind::NoAcknowledge(NoAcknowledgeSource::Data)
    } else if reason & ARBITRATION_LOST != 0 {
        ErrorKind::ArbitrationLoss
    } else {
        ErrorKind::Other
    }
}

fn listen(port: &RegisterBlock, to: u32) {
    // SAFETY: a bit for each interrupt.
    port.ic_intr_mask().write(|w| unsafe { w.bits(to) });
}

/// A line of the bus, which can be pulled low by hand.
pub struct Line<I: PinId>(pub(super) Pin<I, FunctionI2C, PullUp>);

impl<I: PinId + ValidFunction<FunctionI2C>> Line<I> {
    fn release(&mut self) {
        self.0.set_output_enable_override(OutputEnableOverride::Normal);
        self.0.set_output_override(OutputOverride::DontInvert);
    }
}

impl<I: PinId> ErrorType for Line<I> {
    type Error = core::convert::Infallible;
}

impl<I: PinId> OutputPin for Line<I> {
    fn set_low(&mut self) -> Result<(), Self::Error> {
        self.0.set_output_override(OutputOverride::AlwaysLow);
        self.0.set_output_enable_override(OutputEnableOverride::Enable);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Self::Error> {
        self.0.set_output_enable_override(OutputEnableOverride::Disable);
        Ok(())
    }
}

impl<I: PinId> InputPin for Line<I> {
    fn is_high(&mut self) -> Result<bool, Self::Error> {
        self.0.as_input().is_high()
    }

    fn is_low(&mut self) -> Result<bool, Self::Error> {
        self.is_high().map(|is_high| !is_high)
    }
}
