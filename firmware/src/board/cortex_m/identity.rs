//! What every Cortex-M can tell of itself: its kind, its program, the cycles that something takes.

use cortex_m::peripheral::{CPUID, DCB, DWT};

use super::clock;
use crate::app::Instruments;
use crate::job::{OnBoards, Run};
use crate::protocol::{BoardName, Identity};

unsafe extern "C" {
    static __vector_table: u8;
    static __erodata: u8;
}

/// The instruments of this processor, its cycle counter started; `chip` is what the chip says of itself.
pub fn instruments(board: BoardName, hertz: u32, chip: [u32; 4], cpuid: &CPUID, dcb: DCB, dwt: DWT) -> Instruments {
    start(dcb, dwt);
    let identity = Identity { board, hertz, processor: cpuid.base.read(), chip, ..Identity::default() };
    Instruments { stopwatch: clock::cycles, timed, image, identity }
}

/// From flash alone.
fn timed(motion: &mut OnBoards, steps: u32, in_ram: bool) -> u32 {
    if in_ram { 0 } else { cycles_of(|| motion.advance(steps)) }
}

fn image() -> &'static [u8] {
    let start = &raw const __vector_table;
    let length = (&raw const __erodata as usize).wrapping_sub(start as usize);
    // SAFETY: between these two the linker has put the program, which is in flash and never written.
    unsafe { core::slice::from_raw_parts(start, length) }
}

#[cfg(not(armv6m))]
fn start(mut dcb: DCB, mut dwt: DWT) {
    dcb.enable_trace();
    dwt.enable_cycle_counter();
}

/// The cycles that something takes, with interrupts off. QEMU has no cycle counter: it reads 0 there.
#[cfg(not(armv6m))]
pub(in crate::board) fn cycles_of(work: impl FnOnce()) -> u32 {
    cortex_m::interrupt::free(|_| {
        let start = DWT::cycle_count();
        work();
        DWT::cycle_count().wrapping_sub(start)
    })
}

#[cfg(armv6m)]
fn start(_: DCB, _: DWT) {}

/// A Cortex-M0+ has no other counter than the tick's, which is borrowed: the present tick begins anew afterwards. Up to 2^24
/// cycles, 134 ms at 125 MHz.
#[cfg(armv6m)]
pub(in crate::board) fn cycles_of(work: impl FnOnce()) -> u32 {
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
