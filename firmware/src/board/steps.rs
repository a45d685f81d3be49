//! The code of the steps, which is present twice, in flash and in RAM, so that its cycles can be
//! measured in both.
//!
//! The linker keeps the steps together with all functions that they call (`steps.x`). No branch
//! leaves this code (test `steps`), so that it can run at any address.

use super::cortex_m::instruments::cycles_of;
use crate::job::{OnBoards, Run};

unsafe extern "C" {
    /// The address of the steps in the linker's view, in flash or in RAM.
    static __steps_start: u8;
    static __steps_flash: u8;
    static __steps_ram: u8;
}

// Before all other code, start-up copies the steps from flash to RAM.
core::arch::global_asm!(
    ".section .text.__pre_init, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "ldr r0, =__steps_ram",
    "ldr r1, =__steps_ram_end",
    "ldr r2, =__steps_flash",
    "1:",
    "cmp r0, r1",
    "bhs 2f",
    "ldm r2!, {{r3}}",
    "stm r0!, {{r3}}",
    "b 1b",
    "2:",
    "bx lr",
    ".pool",
);

/// Makes `steps` steps of a motion by the copy of the code in RAM (`in_ram`) or in flash, with
/// interrupts off. Boards with this function have both copies. Returns the processor cycles taken,
/// modulo 2^24 on a Cortex-M0+ and 2^32 on a Cortex-M4F; 0 without a cycle counter, as in QEMU.
///
/// The number of steps is not limited here. Of the ticks that end meanwhile the clock counts at
/// most one, and received bytes may be lost. [`instruments::start`] must have started the counter;
/// otherwise the steps are made, and the result is meaningless.
///
/// [`instruments::start`]: super::cortex_m::instruments::start
pub fn timed(motion: &mut OnBoards, steps: u32, in_ram: bool) -> u32 {
    let advance = <OnBoards as Run>::advance as *const ();
    let place = if in_ram {
        &raw const __steps_ram
    } else {
        &raw const __steps_flash
    };

    // The linker knows only one copy. The other is at a fixed distance.
    let distance = (place as usize).wrapping_sub(&raw const __steps_start as usize);
    // SAFETY: at this distance from the function is a copy of it and of all functions that it
    // calls.
    let advance: fn(&mut OnBoards, u32) =
        unsafe { core::mem::transmute(advance.wrapping_byte_add(distance)) };
    cycles_of(|| advance(motion, steps))
}
