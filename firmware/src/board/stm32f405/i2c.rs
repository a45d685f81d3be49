//! The I2C bus of the panel. The support library sets it up, and its interrupts send the bytes.
//!
//! Source: ST RM0090, 27.3.3 (master transmitter and receiver), 27.3.4 (errors); ES0182, the chip's
//! errata.

use cortex_m::asm::delay;
use embedded_hal::i2c::ErrorKind;
use stm32f4xx_hal::gpio::alt::i2c1::{Scl, Sda};
use stm32f4xx_hal::gpio::{PB6, PB7, PinState, Pull};
use stm32f4xx_hal::i2c::I2c;
use stm32f4xx_hal::interrupt;
use stm32f4xx_hal::pac::i2c1::RegisterBlock;
use stm32f4xx_hal::pac::{I2C1, Interrupt};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;

use crate::board::cortex_m::interrupt::unmask;
use crate::board::panel_bus::{self, Bus, PanelPort, TRIES};
use crate::display::{Outbox, SILENCE, Sent, free_bus};

/// Half a clock period of a slow 100 kHz, cycles of 168 MHz.
const HALF_CLOCK: u32 = 840;

/// The bits of the status register.
const START_SENT: u16 = 1 << 0;
const ADDRESS_SENT: u16 = 1 << 1;
const ALL_SENT: u16 = 1 << 2;
const BYTE_READ: u16 = 1 << 6;
const READY_FOR_BYTE: u16 = 1 << 7;

/// The I2C block 1, with its pins PB6 (clock) and PB7 (data), as the port of the panel's bus at 400
/// kHz and a processor of 168 MHz.
pub struct I2c1((Scl, Sda));

pub(super) fn start(port: I2C1, clock: PB6, data: PB7, rcc: &mut Rcc) -> Option<Bus<I2c1>> {
    // The library does not set the pull-ups (RM0090, 8.4.4). At 40 kOhm they are too weak for the
    // bus. But without them and without a panel, the lines would float, which looks like the action
    // of another master.
    let clock = clock.internal_resistor(Pull::Up);
    let data = data.internal_resistor(Pull::Up);
    let (_, pins) = I2c::new(port, (clock, data), 400.kHz(), rcc).release();

    // The panel's messages need both interrupts: one for progress, one for errors.
    let bus = Bus::new(I2c1(pins))?;
    [Interrupt::I2C1_EV, Interrupt::I2C1_ER]
        .into_iter()
        .for_each(unmask);
    Some(bus)
}

impl PanelPort for I2c1 {
    fn begin(&mut self, _: u8) {
        let port = registers();
        // The control register must not be written before the stop is sent.
        let _ = (0..TRIES).any(|_| port.cr1().read().stop().bit_is_clear());
        port.cr1().modify(|_, w| w.pos().clear_bit());
        port.cr2()
            .modify(|_, w| w.itevten().set_bit().iterren().set_bit());
        port.cr1().modify(|_, w| w.start().set_bit());
    }

    fn reset(&mut self) {
        let port = registers();
        silence(port);

        // Free the bus with its pins as ordinary outputs.
        if let (Scl::PB6(clock), Sda::PB7(data)) = &mut self.0 {
            clock.with_open_drain_output_in_state(PinState::High, |clock| {
                data.with_open_drain_output_in_state(PinState::High, |data| {
                    free_bus(|high_clock, high_data| {
                        clock.set_state(high_clock.into());
                        data.set_state(high_data.into());
                        delay(HALF_CLOCK);
                        data.is_high()
                    })
                })
            });
        }

        let frequency = port.cr2().read().bits();
        let clock = port.ccr().read().bits();
        let rise = port.trise().read().bits();

        port.cr1().write(|w| w.swrst().set_bit());
        port.cr1().write(|w| w.swrst().clear_bit());
        // SAFETY: these registers had the same values before.
        unsafe {
            port.cr2().write(|w| w.bits(frequency));
            port.ccr().write(|w| w.bits(clock));
            port.trise().write(|w| w.bits(rise));
        }
        port.cr1().write(|w| w.pe().set_bit());
    }
}

#[interrupt]
fn I2C1_EV() {
    panel_bus::serve(|outbox| advance(registers(), outbox));
}

#[interrupt]
fn I2C1_ER() {
    panel_bus::serve(|_| fail(registers()));
}

fn registers() -> &'static RegisterBlock {
    // SAFETY: while the outbox is not empty, only the interrupts use the bus.
    unsafe { &*I2C1::ptr() }
}

/// Makes the next part of the transfer. Two messages are separated by a start, without a stop.
/// Returns the outcome at the end.
fn advance(port: &RegisterBlock, outbox: &mut Outbox) -> Option<Sent> {
    let status = port.sr1().read().bits();

    // True if all messages are sent, and only the answer is outstanding.
    let reads = outbox.is_empty() && outbox.asked() > 0;
    let is_ready = if status & START_SENT != 0 {
        port.dr()
            .write(|w| w.dr().set(outbox.address << 1 | u8::from(reads)));
        false
    } else if status & ADDRESS_SENT != 0 {
        if reads {
            accept(port, outbox.asked());
        } else {
            let _ = port.sr2().read(); // This read ends the address phase.
        }
        !reads
    } else if reads && is_read(status, outbox.asked()) {
        if outbox.asked() > 1 {
            port.cr1().modify(|_, w| w.stop().set_bit());
        }
        for _ in 0..outbox.asked() {
            outbox.answer(port.dr().read().dr().bits());
        }
        silence(port);
        return Some(Ok(()));
    } else {
        outbox.is_within_message() && status & READY_FOR_BYTE != 0
    };

    if is_ready && let Some(byte) = outbox.next() {
        port.dr().write(|w| w.dr().set(byte.value));
        // After the last byte of a message, only its end interrupts.
        port.cr2()
            .modify(|_, w| w.itbufen().bit(!byte.ends_message));
        return None;
    }

    // Wait until the message is sent. Then make a stop, or start the next message.
    if is_ready || status & ALL_SENT == 0 || outbox.is_within_message() {
        return None;
    }
    if outbox.is_empty() && !reads {
        stop(port);
        return Some(Ok(()));
    }
    port.cr1().modify(|_, w| w.start().set_bit());
    // Wait for the start, because until it is sent the interrupt would repeat.
    if (0..TRIES).any(|_| port.sr1().read().bits() & START_SENT != 0) {
        return None;
    }
    stop(port);
    Some(Err(ErrorKind::Other))
}

/// Ends the address phase of an answer of one byte or two. The last byte is not acknowledged, and a
/// stop follows it.
///
/// Two bytes are both held in the block before the first is read. POS moves the refusal to the
/// second byte, and must be set before the address phase ends. The stop is set when the bus waits
/// after the second byte.
///
/// Source: RM0090, 27.3.3 (master receiver).
fn accept(port: &RegisterBlock, bytes: usize) {
    let is_pair = bytes > 1;
    // The clock is held low until the second register is read.
    port.cr1()
        .modify(|_, w| w.ack().clear_bit().pos().bit(is_pair));
    let _ = port.sr2().read();
    if !is_pair {
        port.cr1().modify(|_, w| w.stop().set_bit());
        port.cr2().modify(|_, w| w.itbufen().set_bit());
    }
}

/// Returns true if the answer is complete. With two bytes, the second waits behind the first. The
/// flag for that alone is not sufficient, because it is also set after the last byte sent.
fn is_read(status: u16, bytes: usize) -> bool {
    let flags = if bytes > 1 {
        BYTE_READ | ALL_SENT
    } else {
        BYTE_READ
    };
    status & flags == flags
}

/// Handles an error of the bus. Returns the outcome, or `None` if the transfer continues.
///
/// A bus error is ignored: a master may detect one by mistake (ES0182, "Spurious bus error
/// detection in master mode"). A bus that has really been disturbed hangs, and is freed for that
/// reason.
fn fail(port: &RegisterBlock) -> Option<Sent> {
    let status = port.sr1().read();
    // Clear the flags read here. Writing a 1 leaves a flag unchanged, so a flag set since then is
    // kept.
    port.sr1().write(|w| {
        w.af()
            .bit(!status.af().bit())
            .arlo()
            .bit(!status.arlo().bit())
            .berr()
            .bit(!status.berr().bit())
    });

    let error = if status.af().bit() {
        SILENCE
    } else if status.arlo().bit() {
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
    port.cr2().modify(|_, w| {
        w.itevten()
            .clear_bit()
            .itbufen()
            .clear_bit()
            .iterren()
            .clear_bit()
    });
}
