//! The I2C bus of the panel. The bus's interrupt sends the bytes, 16 at a time.
//!
//! Source: RP2040 data sheet, 4.3.

use cortex_m::asm::delay;
use embedded_hal::i2c::ErrorKind;
use rp2040_hal::gpio::bank0::{Gpio4, Gpio5};
use rp2040_hal::gpio::{FunctionI2C, Pin, PullUp};
use rp2040_hal::pac::i2c0::RegisterBlock;
use rp2040_hal::pac::io_bank0::GPIO;
use rp2040_hal::pac::{I2C0, IO_BANK0, Interrupt, RESETS, interrupt};

use crate::board::cortex_m::interrupt::unmask;
use crate::board::panel_bus::{self, Bus, PanelPort, TRIES};
use crate::display::{Outbox, SILENCE, Sent, free_bus};

/// The processor's clock, cycles per us. The bus counts these cycles.
const MEGAHERTZ: u32 = 125;
/// The registers of the bus's clock, in cycles, and the longest spike that is suppressed.
///
/// The values of `rp2040-hal` ignore the cycles that the block adds to them, and give 330 to 376
/// kHz. The setup is therefore written here.
const LOW_COUNT: u16 = 175;
const HIGH_COUNT: u16 = 108;
const SPIKE: u8 = 11;
/// The cycles from the fall of the clock to a change of the data: 0.3 us, for devices that see the
/// clock fall late (NXP UM10204, table 10, note 3).
const HOLD: u16 = (MEGAHERTZ * 3 / 10 + 1) as u16;
/// The cycles from the fall to the rise of the clock, and from its rise to its fall.
///
/// Source: RP2040 data sheet, 4.3.14 (the block adds 1 and SPKLEN + 7).
const LOW: u32 = LOW_COUNT as u32 + 1;
const HIGH: u32 = HIGH_COUNT as u32 + SPIKE as u32 + 7;

const fn hertz(rise: u32) -> u32 {
    let cycles_of_1000 = 1000 * (LOW + HIGH) + MEGAHERTZ * rise;
    (1_000_000_000 / cycles_of_1000) * MEGAHERTZ
}
/// The clock is low for at least 1.3 us and high for at least 0.6 us (NXP UM10204, table 10). The
/// SSD1306 requires 2.5 us in all.
const _: () = assert!(1000 * LOW / MEGAHERTZ >= 1300);
const _: () = assert!(1000 * HIGH / MEGAHERTZ >= 600);
/// A line with 4.7 kOhm and 50 pF rises in 0.2 us.
const _: () = assert!(hertz(200) >= 380_000 && hertz(200) <= 400_000);
/// A line with 2.2 kOhm rises in 0.1 us.
const _: () = assert!(hertz(100) <= 400_000);

/// The number of bytes left in the queue when the next are fetched: 90 us before the last is sent.
const FEW: u8 = 4;
/// Half a clock period of a slow 100 kHz, cycles of 125 MHz.
const HALF_CLOCK: u32 = 625;

const NOTHING: u32 = 0;
const FEW_LEFT: u32 = 1 << 4;
const ABORTED: u32 = 1 << 6;
const STOPPED: u32 = 1 << 9;

/// The reason of an abort: an address or a byte was not acknowledged.
const REFUSED: u32 = 1 << 3 | 1 << 0;
/// The reason of an abort: another master had the bus.
const LOST: u32 = 1 << 12;

const DATA: usize = 4;
const CLOCK: usize = 5;

/// The I2C block 0 as the port of the panel's bus: 400 kHz at a processor of 125 MHz.
pub struct I2c0(());

pub(super) type Pins = (
    Pin<Gpio4, FunctionI2C, PullUp>,
    Pin<Gpio5, FunctionI2C, PullUp>,
);

pub(super) fn start(_port: I2C0, _pins: Pins) -> Option<Bus<I2c0>> {
    let bus = Bus::new(I2c0(()))?; // it resets the block, and sets it up
    unmask(Interrupt::I2C0_IRQ);
    Some(bus)
}

fn hold_in_reset(is_held: bool) {
    // SAFETY: the board's start borrows these registers, and has ended or waits for this function.
    // No interrupt writes them.
    let resets = unsafe { &*RESETS::ptr() };
    resets.reset().modify(|_, w| w.i2c0().bit(is_held));
    if !is_held {
        // The block is ready after a few cycles.
        let _ = (0..TRIES).any(|_| resets.reset_done().read().i2c0().bit_is_set());
    }
}

/// Sets the block up after its reset. It stays disabled until the next transfer.
fn set_up(port: &RegisterBlock) {
    listen(port, NOTHING);
    port.ic_con().modify(|_, w| {
        w.speed().fast();
        w.master_mode().enabled();
        w.ic_slave_disable().slave_disabled();
        w.ic_restart_en().enabled();
        w.tx_empty_ctrl().enabled();
        w.rx_fifo_full_hld_ctrl().enabled()
    });

    // SAFETY: the fields take these numbers. The block takes them only while it is disabled.
    unsafe {
        port.ic_tx_tl().write(|w| w.tx_tl().bits(FEW));
        port.ic_rx_tl().write(|w| w.rx_tl().bits(0));
        port.ic_fs_scl_lcnt()
            .write(|w| w.ic_fs_scl_lcnt().bits(LOW_COUNT));
        port.ic_fs_scl_hcnt()
            .write(|w| w.ic_fs_scl_hcnt().bits(HIGH_COUNT));
        port.ic_fs_spklen().write(|w| w.ic_fs_spklen().bits(SPIKE));
        port.ic_sda_hold()
            .modify(|_, w| w.ic_sda_tx_hold().bits(HOLD));
    }
}

impl PanelPort for I2c0 {
    fn begin(&mut self, address: u8) {
        let port = registers();
        // The last stop may still be in progress.
        let _ = (0..TRIES).any(|_| port.ic_status().read().mst_activity().is_idle());

        // The address can be set only while the block is disabled.
        port.ic_enable().write(|w| w.enable().disabled());
        // SAFETY: an address of seven bits.
        port.ic_tar()
            .write(|w| unsafe { w.ic_tar().bits(address.into()) });
        port.ic_enable().write(|w| w.enable().enabled());
        listen(port, FEW_LEFT | ABORTED);
    }

    fn reset(&mut self) {
        // While a device holds the clock low, a transfer does not end, and the block cannot be
        // disabled. Its reset ends every transfer.
        hold_in_reset(true);

        // The pins are driven by hand for this.
        free_bus(|clock, data| {
            drive(CLOCK, clock);
            drive(DATA, data);
            delay(HALF_CLOCK);
            pin(DATA).gpio_status().read().infrompad().bit_is_set()
        });

        // After its reset the block allows most interrupts.
        cortex_m::interrupt::free(|_| {
            hold_in_reset(false);
            set_up(registers());
        });
        // Return the lines to the block.
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
    // SAFETY: no other code uses them. While the outbox is not empty, only the interrupt uses the
    // bus.
    unsafe { &*I2C0::ptr() }
}

/// Makes the next part of the transfer. The last byte of each message is followed by a stop.
/// Returns the outcome at the end.
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

    // All bytes are in the queue of the bus: wait for the last stop.
    if outbox.is_empty() && outbox.requested == outbox.asked() {
        if !status.stop_det().is_active() {
            return None;
        }
        // The stop may belong to an earlier message.
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
        let _ = port.ic_clr_stop_det().read();
        listen(port, STOPPED | ABORTED);
    }
    None
}

fn listen(port: &RegisterBlock, to: u32) {
    // SAFETY: the register has a bit for each interrupt.
    port.ic_intr_mask().write(|w| unsafe { w.bits(to) });
}

fn pin(number: usize) -> &'static GPIO {
    // SAFETY: no other code uses the registers of these pins.
    unsafe { &*IO_BANK0::ptr() }.gpio(number)
}

fn drive(number: usize, high: bool) {
    pin(number).gpio_ctrl().modify(|_, w| {
        if high {
            w.oeover().disable()
        } else {
            w.outover().low().oeover().enable()
        }
    });
}
