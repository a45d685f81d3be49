//! The watchdog: the independent one, which has an oscillator of its own and no interrupt. In the emulator there is none.

use stm32f4xx_hal::pac::{DBGMCU, IWDG};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use crate::board::cortex_m::watchdog;
use crate::config::WATCHDOG_SECONDS;

/// Whether it caused the last reset. To be asked once.
pub(super) fn has_reset(rcc: &mut Rcc) -> bool {
    let has_reset = rcc.csr().read().wdgrstf().bit_is_set();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    has_reset
}

/// Starts it. Its oscillator is good for a factor of 2 (17 to 47 kHz instead of 32).
pub(super) fn start(unit: IWDG) -> IndependentWatchdog {
    let mut unit = IndependentWatchdog::new(unit);
    watchdog::stall_by(stall);
    unit.start((2 * 1000 * WATCHDOG_SECONDS).millis());
    unit
}

fn stall(stalls: bool) {
    // SAFETY: of this register nothing else uses anything.
    let debug = unsafe { &*DBGMCU::ptr() };
    debug.apb1_fz().modify(|_, w| w.dbg_iwdg_stop().bit(stalls));
}

impl watchdog::Watchdog for IndependentWatchdog {
    fn feed(&mut self) {
        Self::feed(self);
    }
}
