//! The chip's watchdog, which has no interrupt: what it resets, it has not been able to ask first.

use rp2040_hal::fugit::ExtU32;
use rp2040_hal::{pac, watchdog as support};

use crate::board::cortex_m::watchdog;
use crate::config::WATCHDOG_SECONDS;

/// The watchdog.
pub struct Watchdog {
    unit: support::Watchdog,
    has_reset: bool,
}

impl Watchdog {
    pub(super) fn new(unit: pac::WATCHDOG) -> Self {
        let has_reset = unit.reason().read().timer().bit_is_set();
        Self { unit: support::Watchdog::new(unit), has_reset }
    }

    /// What the clocks' set-up wants, for it makes the chip's microseconds as well.
    pub(super) fn unit(&mut self) -> &mut support::Watchdog {
        &mut self.unit
    }

    pub(super) fn start(mut self) -> Self {
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

impl watchdog::Watchdog for Watchdog {
    fn feed(&mut self) {
        self.unit.feed();
    }

    fn has_reset(&self) -> bool {
        self.has_reset
    }
}
