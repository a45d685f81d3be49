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
/// The number of ticks since the [`start`], plus [`FIRST`].
static TICKS: AtomicU32 = AtomicU32::new(FIRST);
/// The processor cycles in a tick.
static PERIOD: AtomicU32 = AtomicU32::new(0);

#[exception]
fn SysTick() {
    // A load and a store are sufficient, because only this interrupt writes the counter. An M0+ has
    // no atomic addition.
    TICKS.store(ticks().wrapping_add(1), Ordering::Relaxed);
}

/// Starts a clock of [`TICK_RATE`] ticks per second. It counts while interrupts are on.
///
/// `hertz` is the frequency of the processor, Hz. Not checked: it is at least twice [`TICK_RATE`],
/// below which no tick comes, and at most 1 GHz, because SysTick has 24 bits.
///
/// The period is rounded down to whole processor cycles: at 50 MHz it is 833,333 instead of
/// 833,333.3, so that the clock is 0.4 parts per million fast.
pub fn start(mut systick: SYST, hertz: u32) {
    systick.set_clock_source(SystClkSource::Core);
    PERIOD.store(hertz / TICK_RATE, Ordering::Relaxed);
    // The counter counts from this value down to 0, and then begins again.
    systick.set_reload((hertz / TICK_RATE).saturating_sub(1));
    systick.clear_current();
    systick.enable_interrupt();
    systick.enable_counter();
}

/// Sleeps until the current tick is no longer `last`, and returns the current tick. It may be
/// several ticks later if the caller was late; then the function returns at once. While the ticks
/// are not counted, before [`start`] or with interrupts off, it waits for ever.
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

/// Returns the number of the current tick of 1/60 s. It starts at an arbitrary number, and wraps.
/// It stays the same before [`start`], and while interrupts are off. Of the ticks that end
/// meanwhile, at most one is counted when interrupts are on again.
pub fn ticks() -> u32 {
    TICKS.load(Ordering::Relaxed)
}

/// Returns a count of processor cycles, for differences. It starts at an arbitrary number and wraps
/// at 2^32. Before [`start`] it is meaningless. After interrupts were off for a tick or longer, it
/// may lack whole ticks. A difference is wrong if [`Instruments::timed`] ran in between on a
/// Cortex-M0+.
///
/// [`Instruments::timed`]: crate::app::Instruments::timed
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
