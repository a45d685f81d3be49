//! The watchdog: the independent one, which has an oscillator of its own and no interrupt. In the emulator there is none.

use stm32f4xx_hal::pac::{DBGMCU, IWDG};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Rcc;
use stm32f4xx_hal::watchdog::IndependentWatchdog;

use crate::board::cortex_m::watchdog;
use crate::config::WATCHDOG_SECONDS;

/// The chip's watchdog.
pub struct Independent {
    unit: IndependentWatchdog,
    has_reset: bool,
}

impl Independent {
    /// Starts it. Its oscillator is good for a factor of 2 (17 to 47 kHz instead of 32).
    pub(super) fn start(unit: IWDG, rcc: &mut Rcc) -> Self {
        let has_reset = rcc.csr().read().wdgrstf().bit_is_set();
        rcc.csr().modify(|_, w| w.rmvf().set_bit());
        let mut unit = IndependentWatchdog::new(unit);
        watchdog::stall_by(stall);
        unit.start((2 * 1000 * WATCHDOG_SECONDS).millis());
        Self { unit, has_reset }
    }
}

fn stall(stalls: bool) {
    // SAFETY: of this register nothing else uses anything.
    let debug = unsafe { &*DBGMCU::ptr() };
    debug.apb1_fz().modify(|_, w| w.dbg_iwdg_stop().bit(stalls));
}

impl watchdog::Watchdog for Independent {
    fn feed(&mut self) {
        self.unit.feed();
    }

    fn has_reset(&self) -> bool {
        self.has_reset
    }
}
