//! The stack, and the search for calls on it, which often shows where a program has crashed.
//!
//! The stack is at the lower end of memory, and the statics are above it (`memory.x`). So an
//! overflow leaves memory, however large the frame is, and the chip refuses the access. On the way
//! to the fault handler, it refuses the registers that the processor stacks, too. A Cortex-M3 or M4
//! records this and still runs the handler. An M0+ may lock up. Then the watchdog resets the board,
//! and the next run reports a hang.
//!
//! QEMU's LM3S6965 refuses no address: outside of memory it drops what is written, and reads zeros.
//! There the next return, of a function or of an interrupt, is a jump to 0, which is a fault.

use crate::fault::call_size;

unsafe extern "C" {
    static _stack_start: u8;
    static _stack_end: u8;
    static __stext: u8;
    static __etext: u8;
}

pub fn end() -> u32 {
    &raw const _stack_end as u32
}

/// Returns the addresses of the calls whose return addresses are found on the stack from `sp`
/// upwards, the last call first. Some of them may have returned already, because the stack is not
/// cleared.
pub fn calls(sp: u32) -> impl Iterator<Item = u32> {
    let bottom = sp.max(end()).next_multiple_of(4);
    let words = (bottom..&raw const _stack_start as u32).step_by(4);
    // SAFETY: the addresses are those of whole words of the stack; any pattern is a `u32`.
    words.filter_map(|address| call_before(unsafe { (address as *const u32).read_volatile() }))
}

pub fn instruction(address: u32) -> Option<u16> {
    let code = &raw const __stext as u32..&raw const __etext as u32;
    // SAFETY: any two bytes of the code are a `u16`.
    (address & 1 == 0 && code.contains(&address))
        .then(|| unsafe { (address as *const u16).read_volatile() })
}

/// A return address is in the code, is marked as Thumb code, and follows a call.
fn call_before(address: u32) -> Option<u32> {
    let before = |back: u32| instruction(address.wrapping_sub(back + 1));
    Some(address.wrapping_sub(call_size([before(4)?, before(2)?])? + 1))
}
