//! The lower half of a product of 64 bits, for processors that have no long product.
//!
//! The compiler uses this function for every long product on them. It takes 30 cycles, half the
//! time of the compiler's own library function, which it replaces.
//!
//! Source: Run-time ABI for the Arm architecture, 4.2.

use core::arch::naked_asm;

// SAFETY: a function of the compiler's library has this name, and this function does the same. It
// returns the product of r1:r0 and r3:r2 in r1:r0. It changes r2, r3, r12 and the flags, as the ABI
// allows.
#[unsafe(naked)]
#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_lmul(a: u64, b: u64) -> u64 {
    naked_asm!(
        "muls r1, r2", // the products of the upper halves
        "muls r3, r0",
        "adds r1, r3",
        "mov r12, r1",
        "push {{r4}}", // the lower ones in halves of 16 bits
        "lsrs r1, r0, #16",
        "lsrs r3, r2, #16",
        "uxth r0, r0",
        "uxth r2, r2",
        "mov r4, r1",
        "muls r4, r3",
        "muls r1, r2",
        "muls r3, r0",
        "muls r0, r2",
        "movs r2, #0",
        "adds r1, r3",
        "adcs r2, r2",
        "lsls r2, r2, #16",
        "lsrs r3, r1, #16",
        "lsls r1, r1, #16",
        "adds r0, r1",
        "adcs r3, r2",
        "adds r3, r4",
        "pop {{r4}}",
        "mov r1, r12",
        "adds r1, r3",
        "bx lr",
    )
}
