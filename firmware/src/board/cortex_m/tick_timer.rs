//! Reading a time from a timer that counts down and from the ticks that its interrupt counts.
//!
//! This file uses no register, so that the host can test it (`firmware tick_timer::`).

/// A timer that counts down from `period - 1` to 0 and then begins again, with an interrupt that
/// counts the periods.
pub trait TickTimer {
    fn ticks(&self) -> u32;
    fn counter(&self) -> u32;
    /// True while a period has ended and the interrupt has not yet run.
    fn is_pending(&self) -> bool;
}

/// Returns the time in counts of the timer since tick 0; wraps.
///
/// The reading is right at any moment: also between the reload of the counter and the interrupt,
/// and with interrupts masked for less than a period.
pub fn elapsed(timer: &impl TickTimer, period: u32) -> u32 {
    let last = period.wrapping_sub(1);
    loop {
        let ticks = timer.ticks();
        let counter = timer.counter();
        let is_pending = timer.is_pending();
        if timer.ticks() != ticks {
            // The interrupt came between the readings: the counter may belong to either period.
            continue;
        }

        let start = ticks.wrapping_mul(period);
        if !is_pending {
            return start.wrapping_add(last.wrapping_sub(counter));
        }
        // A period has ended that is not yet in `ticks`. The first counter may have been read
        // before its end, so it is read again. At 0 the period has just ended, and the reload is
        // still to come.
        return match timer.counter() {
            0 => start.wrapping_add(last),
            counter => start
                .wrapping_add(period)
                .wrapping_add(last.wrapping_sub(counter)),
        };
    }
}
