//! The clock of the board: the ticks of SysTick, which every Cortex-M has, counted by its
//! interrupt.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use cortex_m_rt::exception;

use super::tick_timer::{TickTimer, elapsed};
use crate::config::TICK_RATE;

/// The number of the first tick. The counter wraps 5 s later, so that an error at the wrap appears
/// in every test, and not only after 828 days.
const FIRST: u32 = 0_u32.wrapping_sub(5 * TICK_RATE);
static TICKS: AtomicU32 = AtomicU32::new(FIRST);
static PERIOD: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    // A load and a store are sufficient, because only this interrupt writes the counter. An M0+ has
    // no atomic addition.
    TICKS.store(ticks().wrapping_add(1), Ordering::Relaxed);
}

/// Starts the clock of the scene. Each board calls it once, after its PLL runs.
pub fn start(mut systick: SYST, hertz: u32) {
    systick.set_clock_source(SystClkSource::Core);
    PERIOD.store(hertz / TICK_RATE, Ordering::Relaxed);
    systick.set_reload((hertz / TICK_RATE).saturating_sub(1));
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
}

/// Sleeps until the current tick is no longer `last`, and returns the current tick. It may be
/// several ticks later if the caller was late.
pub fn wait_after(last: u32) -> u32 {
    // Interrupts are masked between the test and the sleep, so that an interrupt in between stays
    // pending. A pending interrupt wakes `wfi` even while masked, so no tick is slept through.
    loop {
        let now = cortex_m::interrupt::free(|_| {
            if ticks() == last {
                cortex_m::asm::wfi();
            }
            ticks()
        });
        if now != last {
            return now;
        }
    }
}

/// Returns the number of the current tick. Of the ticks that end while interrupts are off, at most
/// one is counted.
pub fn ticks() -> u32 {
    TICKS.load(Ordering::Relaxed)
}

/// Returns a count of processor cycles, for differences; wraps.
pub fn cycles() -> u32 {
    elapsed(&SysTickTimer, PERIOD.load(Ordering::Relaxed))
}

struct SysTickTimer;

impl TickTimer for SysTickTimer {
    fn ticks(&self) -> u32 {
        ticks()
    }

    fn counter(&self) -> u32 {
        SYST::get_current()
    }

    fn is_pending(&self) -> bool {
        SCB::is_pendst_pending()
    }
}
