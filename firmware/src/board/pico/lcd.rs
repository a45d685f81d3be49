//! The SPI bus of a colour panel. DMA sends a line while the processor converts the next one.
//!
//! Source: RP2040 data sheet, 2.5 (DMA) and 4.4 (SPI); the makers' pages, for the pins.

use cortex_m::asm::delay;
use rp2040_hal::pac::spi0::RegisterBlock;
use rp2040_hal::pac::{DMA, RESETS, SPI0, SPI1};

use super::pins;
use crate::display::PixelBus;
use crate::graphics::{PANEL, PanelName};

struct Wiring {
    is_spi1: bool,
    clock: usize,
    data: usize,
    select: usize,
    data_not_command: usize,
    reset: Option<usize>,
    light: usize,
}

const WIRING: Wiring = match PANEL {
    PanelName::Display | PanelName::Display2 => Wiring {
        is_spi1: false,
        clock: 18,
        data: 19,
        select: 17,
        data_not_command: 16,
        reset: None,
        light: 20,
    },
    _ => Wiring {
        is_spi1: true,
        clock: 10,
        data: 11,
        select: 9,
        data_not_command: 8,
        reset: Some(12),
        light: 13,
    },
};

/// The DMA request of the SPI block for more data: `DREQ_SPI1_TX` or `DREQ_SPI0_TX`.
const REQUEST: u32 = if WIRING.is_spi1 { 18 } else { 16 };
/// The DMA channel's control: enabled, 16 bits, from rising addresses, chained to itself.
const CONTROL: u32 = 1 | 1 << 2 | 1 << 4 | REQUEST << 15;
/// The divisor of 125 MHz, which gives 62.5 MHz, the limit of the data sheet.
const DIVISOR: u8 = 2;
const CYCLES_PER_MS: u32 = 125_000;

/// Two lines of pixels: one is sent while the other is filled.
pub type Lines = [[u16; 320]; 2];

pub struct Lcd {
    lines: &'static mut Lines,
    next: usize,
    is_for_pixels: bool,
}

impl Lcd {
    /// Resets the blocks first, because a reset of the processor alone leaves them running.
    pub fn start(resets: &mut RESETS, lines: &'static mut Lines) -> Self {
        let hold = |resets: &mut RESETS, is_held: bool| {
            resets.reset().modify(|_, w| {
                if WIRING.is_spi1 {
                    w.spi1().bit(is_held).dma().bit(is_held)
                } else {
                    w.spi0().bit(is_held).dma().bit(is_held)
                }
            });
        };
        hold(resets, true);
        hold(resets, false);
        let is_ready = |resets: &RESETS| {
            let done = resets.reset_done().read();
            let spi = if WIRING.is_spi1 {
                done.spi1()
            } else {
                done.spi0()
            };
            spi.bit_is_set() && done.dma().bit_is_set()
        };
        while !is_ready(resets) {}

        // An output starts low, so that the panel, alone on the bus, stays selected.
        let outputs = [WIRING.select, WIRING.data_not_command, WIRING.light];
        outputs.into_iter().for_each(pins::use_for_output);
        pins::use_for_spi(WIRING.clock);
        pins::use_for_spi(WIRING.data);

        let bus = Self {
            lines,
            next: 0,
            // The first command then sets a width of 8 bits.
            is_for_pixels: true,
        };
        let spi = spi();
        // SAFETY: the divisor is even and at least 2.
        spi.sspcpsr()
            .write(|w| unsafe { w.cpsdvsr().bits(DIVISOR) });
        spi.sspdmacr().write(|w| w.txdmae().set_bit());
        spi.sspcr1().write(|w| w.sse().set_bit());

        // The panel is reset by its pin or, without one, by a command.
        if let Some(reset) = WIRING.reset {
            pins::use_for_output(reset);
            delay(CYCLES_PER_MS);
            pins::set(reset, true);
        }
        let mut bus = bus;
        bus.command(SOFTWARE_RESET, &[]);
        bus.wait(AFTER_RESET);
        bus
    }

    /// Waits until everything is sent, and selects the width of a transfer.
    fn become_idle(&mut self, is_for_pixels: bool) {
        while is_sending() {}
        let spi = spi();
        while spi.sspsr().read().bsy().bit_is_set() {}
        if self.is_for_pixels != is_for_pixels {
            let bits = if is_for_pixels { 16 } else { 8 };
            // SAFETY: 8 and 16 bits are possible.
            spi.sspcr0().write(|w| unsafe { w.dss().bits(bits - 1) });
            self.is_for_pixels = is_for_pixels;
        }
    }
}

const SOFTWARE_RESET: u8 = 0x01;
/// The time that a reset takes, ms.
const AFTER_RESET: u32 = 150;

fn spi() -> &'static RegisterBlock {
    let block = if WIRING.is_spi1 {
        SPI1::ptr()
    } else {
        SPI0::ptr()
    };
    // SAFETY: only this module uses the block.
    unsafe { &*block }
}

fn dma() -> &'static rp2040_hal::pac::dma::CH {
    // SAFETY: only this module uses DMA.
    unsafe { (*DMA::ptr()).ch(0) }
}

fn is_sending() -> bool {
    dma().ch_ctrl_trig().read().busy().bit_is_set()
}

/// Puts a byte into the queue of the SPI block, which has room for eight.
fn put(byte: u8) {
    let spi = spi();
    while spi.sspsr().read().tnf().bit_is_clear() {}
    // SAFETY: every byte can be sent.
    spi.sspdr().write(|w| unsafe { w.data().bits(byte.into()) });
}

impl PixelBus for Lcd {
    fn command(&mut self, command: u8, arguments: &[u8]) {
        self.become_idle(false);
        pins::set(WIRING.data_not_command, false);
        put(command);
        // The panel reads the pin with the last bit of a byte.
        while spi().sspsr().read().bsy().bit_is_set() {}
        pins::set(WIRING.data_not_command, true);
        arguments.iter().copied().for_each(put);
    }

    fn buffer(&mut self) -> &mut [u16] {
        let [even, odd] = &mut *self.lines;
        if self.next == 0 { even } else { odd }
    }

    fn send(&mut self, count: usize) {
        if !self.is_for_pixels {
            self.become_idle(true);
        }
        while is_sending() {}
        let line = self.buffer();
        let count = count.min(line.len());
        let from = line.as_ptr();
        let to = spi().sspdr().as_ptr();
        // SAFETY: the line is not written until it is sent, because the next one is another buffer,
        // and this function waits for the one before.
        unsafe {
            let dma = dma();
            dma.ch_read_addr().write(|w| w.bits(from as u32));
            dma.ch_write_addr().write(|w| w.bits(to as u32));
            dma.ch_trans_count().write(|w| w.bits(count as u32));
            dma.ch_ctrl_trig().write(|w| w.bits(CONTROL));
        }
        self.next ^= 1;
    }

    fn wait(&mut self, milliseconds: u32) {
        delay(milliseconds * CYCLES_PER_MS);
    }

    fn light(&mut self) {
        self.become_idle(false);
        pins::set(WIRING.light, true);
    }
}
