//! Calls found on the stack: where a crashed program came from when nothing else tells.

use super::guard;
use crate::fault::call_size;

unsafe extern "C" {
    static __stext: u8;
    static __etext: u8;
    static _stack_start: u8;
}

/// The addresses of the calls, the last one first, that stand on the stack from `sp` upwards. Some may have ended before:
/// the stack is not swept.
pub fn calls(sp: u32) -> impl Iterator<Item = u32> {
    let bottom = sp.max(guard::addresses().end).next_multiple_of(4);
    let words = (bottom..&raw const _stack_start as u32).step_by(4);
    // SAFETY: these are whole words of the stack; any pattern is a `u32`.
    words.filter_map(|address| call_before(unsafe { (address as *const u32).read_volatile() }))
}

/// The halfword at an address in the code.
pub fn instruction(address: u32) -> Option<u16> {
    let code = &raw const __stext as u32..&raw const __etext as u32;
    // SAFETY: any two bytes of the code are a `u16`.
    (address & 1 == 0 && code.contains(&address)).then(|| unsafe { (address as *const u16).read_volatile() })
}

/// The call that returns to this address, if it is one that a call returns to: in the code, marked as Thumb code, and a
/// call before it.
fn call_before(address: u32) -> Option<u32> {
    let before = |back: u32| instruction(address.wrapping_sub(back + 1));
    Some(address.wrapping_sub(call_size([before(4)?, before(2)?])? + 1))
}
