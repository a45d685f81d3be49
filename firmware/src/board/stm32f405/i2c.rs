//! The I2C bus of the panel. The support library sets it up; bytes are sent here, by the bus's interrupts.
//!
//! Source: ST RM0090, 27.3.3 (master transmitter and receiver), 27.3.4 (errors); ES0182, the chip's errata.

use cortex_m::asm::delay;
use cortex_m::peripheral::NVIC;
use embedded_hal::digital::{InputPin, OutputPin};
use embedded_hal::i2c::{ErrorKind, NoAcknowledgeSource};
use stm32f4xx_hal::gpio::alt::i2c1::{Scl, Sda};
use stm32f4xx_hal::gpio::{PB6, PB7, PinState};
use stm32f4xx_hal::i2c::I2c;
use stm32f4xx_hal::interrupt;
use stm32f4xx_hal::pac::i2c1::RegisterBlock;
use stm32f4xx_hal::pac::{I2C1, Interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;

use crate::board::panel_bus::{self, Bus, PanelPort};
use crate::display::{Lines, Outbox, Sent, free_bus};

/// Half a clock of a slow 100 kHz, cycles of 168 MHz.
const HALF_CLOCK: u32 = 840;
/// How often a start or stop is waited for, which takes 5 us: these tries take at least 12.
const TRIES: u32 = 500;

const START_SENT: u16 = 1 << 0;
const ADDRESS_SENT: u16 = 1 << 1;
const ALL_SENT: u16 = 1 << 2;
const BYTE_READ: u16 = 1 << 6;
const READY_FOR_BYTE: u16 = 1 << 7;

pub struct I2c1 {
    port: I2C1,
    pins: (Scl, Sda),
}

pub(super) fn start(port: I2C1, clock: PB6, data: PB7, rcc: &mut Rcc, outbox: &'static mut Outbox) -> Bus<I2c1> {
    let (port, pins) = I2c::new(port, (clock, data), 400.kHz(), rcc).release();
    let mut port = I2c1 { port, pins };
    port.reset();
    // SAFETY: no critical section relies on these interrupts being masked.
    unsafe {
        NVIC::unmask(Interrupt::I2C1_EV);
        NVIC::unmask(Interrupt::I2C1_ER);
    }
    Bus::new(port, outbox)
}

impl PanelPort for I2c1 {
    fn begin(&mut self, _: u8) {
        let port = &self.port;
        // The control register is not to be written before.
        let _ = (0..TRIES).any(|_| port.cr1().read().stop().bit_is_clear());
        port.cr2().modify(|_, w| w.itevten().set_bit().iterren().set_bit());
        port.cr1().modify(|_, w| w.start().set_bit());
    }

    fn reset(&mut self) {
        let port = &self.port;
        silence(port);
        if let (Scl::PB6(clock), Sda::PB7(data)) = &mut self.pins {
            clock.with_open_drain_output_in_state(PinState::High, |clock| {
                data.with_open_drain_output_in_state(PinState::High, |data| free_bus(&mut ByHand(clock, data)))
            });
        }
        let (frequency, clock, rise) = (port.cr2().read().bits(), port.ccr().read().bits(), port.trise().read().bits());
        port.cr1().write(|w| w.swrst().set_bit());
        port.cr1().write(|w| w.swrst().clear_bit());
        // SAFETY: they are what these registers held before.
        port.cr2().write(|w| unsafe { w.bits(frequency) });
        // SAFETY: as above.
        port.ccr().write(|w| unsafe { w.bits(clock) });
        // SAFETY: as above.
        port.trise().write(|w| unsafe { w.bits(rise) });
        port.cr1().write(|w| w.pe().set_bit());
    }
}

/// The bus's lines, driven by hand.
struct ByHand<'a, Clock, Data>(&'a mut Clock, &'a mut Data);

impl<Clock: OutputPin, Data: OutputPin + InputPin> Lines for ByHand<'_, Clock, Data> {
    fn set_clock(&mut self, high: bool) {
        let _ = self.0.set_state(high.into());
    }

    fn set_data(&mut self, high: bool) {
        let _ = self.1.set_state(high.into());
    }

    fn is_data_high(&mut self) -> bool {
        self.1.is_high().unwrap_or_default()
    }

    fn wait(&mut self) {
        delay(HALF_CLOCK);
    }
}

#[interrupt]
fn I2C1_EV() {
    panel_bus::serve(|outbox| advance(registers(), outbox));
}

#[interrupt]
fn I2C1_ER() {
    panel_bus::serve(|outbox| fail(registers(), outbox));
}

fn registers() -> &'static RegisterBlock {
    // SAFETY: while there is something in the outbox the bus is the interrupts'.
    unsafe { &*I2C1::ptr() }
}

/// Does what the bus waits for. Between two messages there is no stop but a start.
fn advance(port: &RegisterBlock, outbox: &mut Outbox) -> Option<Sent> {
    let status = port.sr1().read().bits();
    // What is left then is to read the status.
    let reads = outbox.is_empty() && outbox.asks;
    let is_ready = if status & START_SENT != 0 {
        port.dr().write(|w| w.dr().set(outbox.address << 1 | u8::from(reads)));
        false
    } else if status & ADDRESS_SENT != 0 {
        let _ = port.sr2().read(); // Only this ends the address phase.
        if reads {
            // One byte, which is not acknowledged.
            port.cr1().modify(|_, w| w.stop().set_bit());
            port.cr2().modify(|_, w| w.itbufen().set_bit());
        }
        !reads
    } else if reads && status & BYTE_READ != 0 {
        outbox.status = port.dr().read().dr().bits();
        silence(port);
        return Some(Ok(()));
    } else {
        outbox.is_within_message() && status & READY_FOR_BYTE != 0
    };
    if is_ready && let Some(byte) = outbox.next() {
        port.dr().write(|w| w.dr().set(byte.value));
        // After the last byte of a message only its end interrupts.
        port.cr2().modify(|_, w| w.itbufen().bit(!byte.ends_message));
        return None;
    }
    if is_ready || status & ALL_SENT == 0 || outbox.is_within_message() {
        return None;
    }
    if outbox.is_empty() && !reads {
        stop(port);
        return Some(Ok(()));
    }
    port.cr1().modify(|_, w| w.start().set_bit());
    // Until it is sent the interrupt would come again and again.
    if (0..TRIES).any(|_| port.sr1().read().bits() & START_SENT != 0) {
        return None;
    }
    stop(port);
    Some(Err(ErrorKind::Other))
}

/// A bus error is none: a master may detect one where there is none, so it is cleared and the transfer goes on (ES0182,
/// "Spurious bus error detection in master mode"). A bus that has really been disturbed hangs, and is freed for that.
fn fail(port: &RegisterBlock, outbox: &Outbox) -> Option<Sent> {
    let status = port.sr1().read();
    // To write 1 leaves a flag as it is: one that has come up meanwhile.
    port.sr1()
        .write(|w| w.af().bit(!status.af().bit()).arlo().bit(!status.arlo().bit()).berr().bit(!status.berr().bit()));
    let error = if status.af().bit_is_set() {
        let source = if outbox.has_begun() { NoAcknowledgeSource::Data } else { NoAcknowledgeSource::Address };
        ErrorKind::NoAcknowledge(source)
    } else if status.arlo().bit_is_set() {
        ErrorKind::ArbitrationLoss
    } else {
        return None;
    };
    stop(port);
    Some(Err(error))
}

fn stop(port: &RegisterBlock) {
    silence(port);
    port.cr1().modify(|_, w| w.stop().set_bit());
}

fn silence(port: &RegisterBlock) {
    port.cr2().modify(|_, w| w.itevten().clear_bit().itbufen().clear_bit().iterren().clear_bit());
}
