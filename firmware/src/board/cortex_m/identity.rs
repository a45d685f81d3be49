//! What every Cortex-M can tell of itself: its kind, its program, the cycles that something takes.

use cortex_m::peripheral::{CPUID, DCB, DWT};

use super::{clock, stopwatch};
use crate::app::Instruments;
use crate::job::{OnBoards, Run};
use crate::protocol::{BoardName, Identity};

unsafe extern "C" {
    static __vector_table: u8;
    static __erodata: u8;
}

/// The instruments of this processor, its cycle counter started; `chip` is what the chip says of itself.
pub fn instruments(board: BoardName, hertz: u32, chip: [u32; 4], cpuid: &CPUID, dcb: DCB, dwt: DWT) -> Instruments {
    stopwatch::start(dcb, dwt);
    let identity = Identity { board: board.code(), hertz, processor: cpuid.base.read(), chip, ..Identity::default() };
    Instruments { stopwatch: clock::cycles, timed, image, identity }
}

/// From flash alone.
fn timed(motion: &mut OnBoards, steps: u32, in_ram: bool) -> u32 {
    if in_ram { 0 } else { stopwatch::timed(|| motion.advance(steps)) }
}

fn image() -> &'static [u8] {
    let start = &raw const __vector_table;
    let length = (&raw const __erodata as usize).wrapping_sub(start as usize);
    // SAFETY: between these two the linker has put the program, which is in flash and never written.
    unsafe { core::slice::from_raw_parts(start, length) }
}
