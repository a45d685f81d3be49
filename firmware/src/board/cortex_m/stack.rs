//! The stack's guard: a stack that grows too long is stopped before it writes on anything. And the calls found on the stack: where a
//! crashed program came from when nothing else tells.
//!
//! The upper 32 KB of memory are the stack's, and it grows downwards. The statics are at the bottom of the lower 32 KB;
//! what they leave of it, in eighths of 4 KB, the memory protection unit refuses to everyone. `memory.x` sees to it that
//! they leave at least 8 KB.
//!
//! A thinner guard would do against a creeping stack, but a function that takes kilobytes at once, as those do that make
//! a scene, could step over it. No function of the firmware takes as much as this guard holds, with
//! what the next call pushes and a margin of 512 bytes (test `stack_guard`), so the
//! stack pointer cannot pass it; and wherever it stops within, the next call or interrupt is refused.
//!
//! So are the registers that the processor stacks on its way to the fault's handler. A Cortex-M3 or M4 notes that and takes the
//! handler all the same; an M0+, which has nothing to note it in, may lock up. Then the watchdog resets the board, and what the
//! next run reports is a hang.

use core::ops::Range;

use cortex_m::peripheral::MPU;

use crate::fault::call_size;

/// The part of memory that the unit's one region covers, bytes from the start of memory; the rest is the stack's.
const REGION: u32 = 32 * 1024;
/// What the region can be switched off by.
const EIGHTH: u32 = REGION / 8;

/// Region number 0, given with its base address.
const REGION_0: u32 = 1 << 4;
/// No execution, no access (AP = 0); ordinary memory.
const NO_ACCESS: u32 = 1 << 28 | 1 << 18 | 1 << 17;
/// A region has 2^(SIZE + 1) bytes.
const SIZE: u32 = (REGION.ilog2() - 1) << 1;
const REGION_ON: u32 = 1 << 0;
/// All other memory stays as it is. Faults are handled with the unit off.
const UNIT_ON: u32 = 1 << 2 | 1 << 0;

unsafe extern "C" {
    static _ram_start: u8;
    static __euninit: u8;
    static _stack_start: u8;
    static __stext: u8;
    static __etext: u8;
}

/// Where the guard is.
fn guard() -> Range<u32> {
    let start = &raw const _ram_start as u32;
    let statics = (&raw const __euninit as u32).wrapping_sub(start);
    start.wrapping_add(statics.next_multiple_of(EIGHTH).min(REGION))..start.wrapping_add(REGION)
}

/// Puts the guard up; says so if this processor has no memory protection unit.
///
/// Source: ARM DDI 0403, B3.5.
pub fn guard_stack(unit: MPU) {
    let regions = unit._type.read() >> 8 & 0xff;
    if regions == 0 {
        defmt::warn!("no memory protection unit: the stack has no guard");
        return;
    }
    let Range { start, end } = guard();
    let base = end.wrapping_sub(REGION);
    // A bit for each eighth that is not refused, from the lowest.
    let statics = (1_u32 << (start.wrapping_sub(base) / EIGHTH)) - 1;
    // SAFETY: nothing but the stack uses these addresses, and it must not.
    unsafe {
        unit.rbar.write(base | REGION_0);
        unit.rasr.write(NO_ACCESS | statics << 8 | SIZE | REGION_ON);
        unit.ctrl.write(UNIT_ON);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// The addresses of the calls, the last one first, that stand on the stack from `sp` upwards. Some may have ended before:
/// the stack is not swept.
pub fn calls(sp: u32) -> impl Iterator<Item = u32> {
    let bottom = sp.max(guard().end).next_multiple_of(4);
    let words = (bottom..&raw const _stack_start as u32).step_by(4);
    // SAFETY: these are whole words of the stack; any pattern is a `u32`.
    words.filter_map(|address| call_before(unsafe { (address as *const u32).read_volatile() }))
}

/// The halfword at an address in the code.
pub fn instruction(address: u32) -> Option<u16> {
    let code = &raw const __stext as u32..&raw const __etext as u32;
    // SAFETY: any two bytes of the code are a `u16`.
    (address & 1 == 0 && code.contains(&address))
        .then(|| unsafe { (address as *const u16).read_volatile() })
}

/// The call that returns to this address, if it is one that a call returns to: in the code, marked as Thumb code, and a
/// call before it.
fn call_before(address: u32) -> Option<u32> {
    let before = |back: u32| instruction(address.wrapping_sub(back + 1));
    Some(address.wrapping_sub(call_size([before(4)?, before(2)?])? + 1))
}
