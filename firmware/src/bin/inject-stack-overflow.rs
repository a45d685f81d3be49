//! Calls itself until the stack is full, for the test of its guard. Without one it goes on some way into the statics,
//! then says so.
#![no_std]
#![no_main]

use core::hint::black_box;
use core::mem::MaybeUninit;

use cortex_m_semihosting::debug;

unsafe extern "C" {
    static __euninit: u8;
}

/// How far into the statics it goes, bytes.
const DAMAGE: usize = 256;
/// The last of the statics, so that without the guard nothing is damaged that the way back needs.
#[unsafe(link_section = ".uninit.last")]
static LAST: MaybeUninit<[u8; 2 * DAMAGE]> = MaybeUninit::uninit();

#[cortex_m_rt::entry]
fn main() -> ! {
    let Some(core) = cortex_m::Peripherals::take() else { panic!("the core was taken before") };
    firmware::board::cortex_m::guard::guard_stack(core.MPU);
    black_box(&LAST);
    defmt::info!("boot: about to overflow the stack");
    let depth = descend(0, &raw const __euninit as usize - DAMAGE);
    defmt::error!("{} calls deep, and nothing has stopped it", depth);
    loop {
        debug::exit(debug::EXIT_SUCCESS);
    }
}

/// Goes on until the stack reaches down to `end`; how many calls deep.
#[inline(never)]
#[unsafe(no_mangle)]
fn descend(depth: u32, end: usize) -> u32 {
    // Something to keep on the stack, and to come back to: no loop can take the place of this call.
    let local = black_box([depth; 8]);
    if (local.as_ptr() as usize) < end {
        return depth;
    }
    descend(depth + 1, end).max(black_box(local)[0])
}
