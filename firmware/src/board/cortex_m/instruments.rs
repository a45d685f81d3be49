//! The measuring functions of every Cortex-M, its identity, and the start of its parts.

use cortex_m::Peripherals;
use cortex_m::peripheral::{DCB, DWT};
use double_pendulum::parts::Advance;

use super::clock;
use crate::app::Instruments;
use crate::protocol::{BoardName, Identity};

unsafe extern "C" {
    static __vector_table: u8;
    static __erodata: u8;
}

/// Starts the tick and the cycle counter, which a Cortex-M0+ lacks. Returns the measuring functions
/// and the identity.
/// are 0, and stay so; only the result of [`Instruments::identity()`] contains them.
pub fn start(core: Peripherals, board: BoardName, hertz: u32, chip: [u32; 4]) -> Instruments {
    clock::start(core.SYST, hertz);
    start_counter(core.DCB, core.DWT);

    let processor = core.CPUID.base.read();
    let identity = Identity {
        board,
        hertz,
        processor,
        chip,
        ..Identity::default()
    };
    Instruments {
        stopwatch: clock::cycles,
        timed: |motion, steps| cycles_of(|| motion.advance(steps)),
        image,
        identity,
    }
}

fn image() -> &'static [u8] {
    let start = &raw const __vector_table;
    let length = (&raw const __erodata as usize).wrapping_sub(start as usize);
    // SAFETY: the linker has put the program between these two symbols. It is in flash and is never
    // written.
    unsafe { core::slice::from_raw_parts(start, length) }
}

#[cfg(not(armv6m))]
fn start_counter(mut dcb: DCB, mut dwt: DWT) {
    dcb.enable_trace();
    dwt.enable_cycle_counter();
}

/// Calls `work` once with interrupts off, and returns the processor cycles that it took. QEMU has
/// no cycle counter; there the result is 0.
#[cfg(not(armv6m))]
fn cycles_of(work: impl FnOnce()) -> u32 {
    cortex_m::interrupt::free(|_| {
        let start = DWT::cycle_count();
        work();
        DWT::cycle_count().wrapping_sub(start)
    })
}

#[cfg(armv6m)]
fn start_counter(_: DCB, _: DWT) {}

/// Calls `work` once with interrupts off, and returns the processor cycles that it took, modulo
/// 2^24.
///
/// The only counter of a Cortex-M0+ is the tick's; the current tick begins again afterwards.
#[cfg(armv6m)]
fn cycles_of(work: impl FnOnce()) -> u32 {
    use cortex_m::peripheral::SYST;
    const FULL: u32 = (1 << 24) - 1;
    cortex_m::interrupt::free(|_| {
        // SAFETY: interrupts stay off until the clock's reload value is restored, so that nothing
        // reads the counter in between.
        let mut counter = unsafe { Peripherals::steal() }.SYST;
        let reload = SYST::get_reload();
        counter.set_reload(FULL);
        counter.clear_current();
        work();
        let taken = FULL.wrapping_sub(SYST::get_current());

        counter.set_reload(reload);
        counter.clear_current();
        taken
    })
}
