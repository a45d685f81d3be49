//! The chip's watchdog, which has no interrupt: what it resets, it has not been able to ask first.
//!
//! Its own word for a reset of its making, REASON, is not enough. The boot ROM resets the chip by the same watchdog after each
//! download, and a debugger's reset, which is one of the processor alone (SYSRESETREQ), leaves what REASON said before.
//!
//! Source: RP2040 data sheet, 2.8 (boot sequence), 2.13 (what the watchdog resets), 2.14 (subsystem resets), 4.7 (watchdog).

use rp2040_hal::fugit::ExtU32;
use rp2040_hal::{pac, watchdog as support};

use crate::board::cortex_m::watchdog;
use crate::config::WATCHDOG_SECONDS;

/// What the SDK's `watchdog_enable` writes into a scratch register, which a reset leaves alone, but whoever uses the watchdog to
/// restart the chip on purpose overwrites.
const STARTED: u32 = 0x6ab7_3121;

/// The watchdog.
pub struct Dog {
    unit: support::Watchdog,
    has_reset: bool,
}

impl Dog {
    /// To be called before anything is taken out of its reset. The watchdog puts all there is into reset, a debugger does not.
    pub(super) fn new(unit: pac::WATCHDOG, resets: &pac::RESETS) -> Self {
        let has_reset = unit.reason().read().timer().bit_is_set()
            && unit.scratch4().read().bits() == STARTED
            && resets.reset().read().i2c0().bit_is_set();
        Self { unit: support::Watchdog::new(unit), has_reset }
    }

    /// What the clocks' set-up wants, for it makes the chip's microseconds as well.
    pub(super) fn unit(&mut self) -> &mut support::Watchdog {
        &mut self.unit
    }

    pub(super) fn start(mut self) -> Self {
        self.unit.write_scratch(support::ScratchRegister::Scratch4, STARTED);
        self.unit.start((2 * WATCHDOG_SECONDS).secs());
        watchdog::stall_by(stall);
        self
    }
}

fn stall(stalls: bool) {
    // SAFETY: the support library uses other bits of this register, and not any more.
    let unit = unsafe { &*pac::WATCHDOG::ptr() };
    unit.ctrl().modify(|_, w| w.pause_dbg0().bit(stalls).pause_dbg1().bit(stalls).pause_jtag().bit(stalls));
}

impl watchdog::Watchdog for Dog {
    fn feed(&mut self) {
        self.unit.feed();
    }

    fn has_reset(&self) -> bool {
        self.has_reset
    }
}
