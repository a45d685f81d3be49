//! The cycles that something takes, with interrupts off.

use cortex_m::peripheral::{DCB, DWT};

#[cfg(not(armv6m))]
pub fn start(mut dcb: DCB, mut dwt: DWT) {
    dcb.enable_trace();
    dwt.enable_cycle_counter();
}

/// QEMU has no cycle counter: it reads 0 there.
#[cfg(not(armv6m))]
pub fn timed(work: impl FnOnce()) -> u32 {
    cortex_m::interrupt::free(|_| {
        let start = DWT::cycle_count();
        work();
        DWT::cycle_count().wrapping_sub(start)
    })
}

#[cfg(armv6m)]
pub fn start(_: DCB, _: DWT) {}

/// A Cortex-M0+ has no other counter than the tick's, which is borrowed: the present tick begins anew afterwards. Up to 2^24
/// cycles, 134 ms at 125 MHz.
#[cfg(armv6m)]
pub fn timed(work: impl FnOnce()) -> u32 {
    use cortex_m::peripheral::SYST;
    const FULL: u32 = (1 << 24) - 1;
    // SAFETY: interrupts stay off until the clock's reload value is restored, so nothing reads the counter in between.
    let begin = |reload: u32| unsafe {
        let counter = &*SYST::PTR;
        counter.rvr.write(reload);
        counter.cvr.write(0);
    };
    cortex_m::interrupt::free(|_| {
        let reload = SYST::get_reload();
        begin(FULL);
        work();
        let taken = FULL.wrapping_sub(SYST::get_current());
        begin(reload);
        taken
    })
}
