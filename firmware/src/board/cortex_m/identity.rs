//! What every Cortex-M can tell of itself: its kind, its program, the cycles that something takes.

use cortex_m::peripheral::{CPUID, DCB, DWT};

use super::clock;
use crate::app::instruments::Instruments;
use crate::protocol::{BoardName, Identity};

unsafe extern "C" {
    /// The start of the program in flash.
    static __vector_table: u8;
    /// The end of its constants.
    static __erodata: u8;
}

/// The instruments of this processor, its cycle counter started; `chip` is what the chip says of itself.
pub fn instruments(
    board: BoardName,
    hertz: u32,
    chip: [u32; 4],
    cpuid: &CPUID,
    mut dcb: DCB,
    mut dwt: DWT,
) -> Instruments {
    dcb.enable_trace();
    dwt.enable_cycle_counter();
    let identity = Identity { board: board.code(), hertz, processor: cpuid.base.read(), chip, ..Identity::default() };
    Instruments { stopwatch: clock::cycles, timed, image, identity }
}

/// QEMU has no cycle counter: it reads 0 there.
fn timed(work: &mut dyn FnMut()) -> u32 {
    cortex_m::interrupt::free(|_| {
        let start = DWT::cycle_count();
        work();
        DWT::cycle_count().wrapping_sub(start)
    })
}

fn image() -> &'static [u8] {
    let start = &raw const __vector_table;
    let length = (&raw const __erodata as usize).wrapping_sub(start as usize);
    // SAFETY: between these two the linker has put the program, which is in flash and never written.
    unsafe { core::slice::from_raw_parts(start, length) }
}
