//! The chip's watchdog, which has no interrupt: what it resets, it has not been able to ask first.
//!
//! Its own word for a reset of its making, REASON, is not enough. The boot ROM resets the chip by the same watchdog after each
//! download, and a debugger's reset, which is one of the processor alone (SYSRESETREQ), leaves what REASON said before.
//!
//! Source: RP2040 data sheet, 2.8 (boot sequence), 2.13 (what the watchdog resets), 2.14 (subsystem resets), 4.7 (watchdog).

use rp2040_hal::fugit::ExtU32;
use rp2040_hal::pac;
use rp2040_hal::watchdog::{ScratchRegister, Watchdog};

use crate::board::cortex_m::watchdog;
use crate::config::WATCHDOG_SECONDS;

/// What the SDK's `watchdog_enable` writes into a scratch register, which a reset leaves alone, but whoever uses the watchdog to
/// restart the chip on purpose overwrites.
const STARTED: u32 = 0x6ab7_3121;

/// Whether it caused the last reset. To be asked before anything is taken out of its reset: the watchdog puts all there is into
/// reset, a debugger does not.
pub(super) fn has_reset(unit: &pac::WATCHDOG, resets: &pac::RESETS) -> bool {
    unit.reason().read().timer().bit_is_set()
        && unit.scratch4().read().bits() == STARTED
        && resets.reset().read().i2c0().bit_is_set()
}

/// Starts it; the clocks' set-up has had it before, for it makes the chip's microseconds as well.
pub(super) fn start(mut unit: Watchdog) -> Watchdog {
    unit.write_scratch(ScratchRegister::Scratch4, STARTED);
    unit.start((2 * WATCHDOG_SECONDS).secs());
    watchdog::stall_by(stall);
    unit
}

fn stall(stalls: bool) {
    // SAFETY: the support library uses other bits of this register, and not any more.
    let unit = unsafe { &*pac::WATCHDOG::ptr() };
    unit.ctrl().modify(|_, w| w.pause_dbg0().bit(stalls).pause_dbg1().bit(stalls).pause_jtag().bit(stalls));
}

impl watchdog::Watchdog for Watchdog {
    fn feed(&mut self) {
        Self::feed(self);
    }
}
