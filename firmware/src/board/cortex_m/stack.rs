//! The stack guard, which stops the stack before it overwrites anything. Also the search for calls
//! on the stack, which often shows where a program has crashed.
//!
//! The upper 32 KB of memory are for the stack, which grows downwards. The statics are at the
//! bottom of the lower 32 KB, and the guard is the rest of the lower 32 KB: the memory protection
//! unit blocks all access to it. The guard begins at a multiple of 4 KB. `memory.x` ensures that it
//! has at least 8 KB.
//!
//! The guard is that large because a function with kilobytes of local variables, such as a
//! constructor of a scene, could step over a thinner one. No function of the firmware takes as
//! much as the guard, with a margin of 512 bytes and the registers that the next call pushes (test
//! `stack_guard`). So the stack pointer cannot pass the guard. If it stops within the guard, the
//! next call or interrupt is refused.
//!
//! Then the registers that the processor stacks on its way to the fault handler are refused as
//! well. A Cortex-M3 or M4 records this and still runs the handler. An M0+, which cannot record it,
//! may lock up. Then the watchdog resets the board, and the next run reports a hang.

use core::ops::Range;

use cortex_m::peripheral::MPU;

use crate::fault::call_size;

/// The part of memory that the unit's only region covers, bytes from the start of memory. The rest
/// is for the stack.
const REGION: u32 = 32 * 1024;
/// The size of a part of the region that can be switched off.
const EIGHTH: u32 = REGION / 8;

/// Region number 0, which is written with its base address.
const REGION_0: u32 = 1 << 4;
/// The attributes of the guard: no execution, no access (AP = 0), ordinary memory.
const NO_ACCESS: u32 = 1 << 28 | 1 << 18 | 1 << 17;
/// A region has 2^(SIZE + 1) bytes.
const SIZE: u32 = (REGION.ilog2() - 1) << 1;
/// The region is in force.
const REGION_ON: u32 = 1 << 0;
/// The unit is on. Other memory is accessible as before. Faults are handled with the unit off.
const UNIT_ON: u32 = 1 << 2 | 1 << 0;

unsafe extern "C" {
    static _ram_start: u8;
    static __euninit: u8;
    static _stack_start: u8;
    static __stext: u8;
    static __etext: u8;
}

/// Returns the addresses of the guard.
fn guard() -> Range<u32> {
    let start = &raw const _ram_start as u32;
    let statics = (&raw const __euninit as u32).wrapping_sub(start);
    start.wrapping_add(statics.next_multiple_of(EIGHTH).min(REGION))..start.wrapping_add(REGION)
}

/// Sets the guard up; from then on an access to it is a fault. If the processor has no memory
/// protection unit, only logs a warning, which is lost if the log is not open.
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
    // A bit for each eighth that is accessible, from the lowest.
    let statics = (1_u32 << (start.wrapping_sub(base) / EIGHTH)) - 1;
    // SAFETY: only the stack uses these addresses, and it must not.
    unsafe {
        unit.rbar.write(base | REGION_0);
        unit.rasr.write(NO_ACCESS | statics << 8 | SIZE | REGION_ON);
        unit.ctrl.write(UNIT_ON);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Returns the addresses of the call instructions whose return addresses are found on the stack
/// from `sp` upwards, the last call first. `sp` is rounded up to a multiple of 4. One within the
/// guard or below counts as the lowest address of the stack, and one above the stack gives none.
/// Some of the calls may have returned already, because the stack is not cleared. Calls within the
/// steps are missing on a board that has them twice ([`instruction`]).
pub fn calls(sp: u32) -> impl Iterator<Item = u32> {
    let bottom = sp.max(guard().end).next_multiple_of(4);
    let words = (bottom..&raw const _stack_start as u32).step_by(4);
    // SAFETY: the addresses are those of whole words of the stack; any pattern is a `u32`.
    words.filter_map(|address| call_before(unsafe { (address as *const u32).read_volatile() }))
}

/// Returns the halfword at an address of the code in flash; `None` outside it and at odd addresses.
pub fn instruction(address: u32) -> Option<u16> {
    let code = &raw const __stext as u32..&raw const __etext as u32;
    // SAFETY: any two bytes of the code are a `u16`.
    (address & 1 == 0 && code.contains(&address))
        .then(|| unsafe { (address as *const u16).read_volatile() })
}

/// Returns the address of the call that returns to this address. Returns `None` if it is no return
/// address: it must be in the code, be marked as Thumb code, and follow a call.
fn call_before(address: u32) -> Option<u32> {
    let before = |back: u32| instruction(address.wrapping_sub(back + 1));
    Some(address.wrapping_sub(call_size([before(4)?, before(2)?])? + 1))
}
