//! The tick: SysTick, which every Cortex-M has, counted by its interrupt.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use cortex_m_rt::exception;

use super::tick_timer::{TickTimer, elapsed};
use crate::config::TICK_RATE;

/// Where the ticks are counted from: 5 s before they wrap, so that what goes wrong there does so in every test and not
/// after 828 days.
const FIRST: u32 = 0_u32.wrapping_sub(5 * TICK_RATE);
/// Ticks since the [`start`], and [`FIRST`].
static TICKS: AtomicU32 = AtomicU32::new(FIRST);
static PERIOD: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    // Only this writes it: an M0+ cannot add in one go.
    TICKS.store(ticks().wrapping_add(1), Ordering::Relaxed);
}

/// Starts a clock of [`TICK_RATE`] ticks per second from the processor's of `hertz`. The period is rounded down to whole processor
/// cycles: at 50 MHz 833,333 instead of 833,333.3, which is 0.4 parts per million fast.
pub fn start(mut systick: SYST, hertz: u32) {
    systick.set_clock_source(SystClkSource::Core);
    PERIOD.store(hertz / TICK_RATE, Ordering::Relaxed);
    systick.set_reload((hertz / TICK_RATE).saturating_sub(1));
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
}

/// Sleeps until the tick after `last`; returns at once if it has passed already.
pub fn wait_after(last: u32) -> u32 {
    // An interrupt between the test and the sleep stays pending only while interrupts are masked: with them
    // masked `wfi` still wakes, so no tick is slept through.
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

/// Counts ticks, from any number on; wraps.
pub fn ticks() -> u32 {
    TICKS.load(Ordering::Relaxed)
}

/// Returns the processor cycles since the clock's start; wraps.
pub fn cycles() -> u32 {
    elapsed(&SysTickTimer, PERIOD.load(Ordering::Relaxed))
}

/// SysTick and its ticks.
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
