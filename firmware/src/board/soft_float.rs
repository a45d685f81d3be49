//! [`soft_float`](crate::soft_float) under the names by which the compiler calls for it. Its own library's functions give
//! way to these: they take half as long again.
//!
//! Source: Run-time ABI for the Arm architecture, 4.1.2: arguments and results are in the integer registers, also where
//! there is a floating-point unit.

use crate::soft_float::{Word, add, multiply};

// SAFETY (all): the names are those of functions of the compiler's library, which gives way to these, and these do what the
// names say: the standard's operations on the bits of the standard's formats.

#[cfg(target_abi = "eabi")] // where there is no floating-point unit
mod single {
    use super::*;

    #[unsafe(no_mangle)]
    #[inline(never)]
    extern "aapcs" fn __aeabi_fadd(a: u32, b: u32) -> u32 {
        add(a, b)
    }

    #[unsafe(no_mangle)]
    extern "aapcs" fn __aeabi_fsub(a: u32, b: u32) -> u32 {
        __aeabi_fadd(a, b ^ u32::SIGN)
    }

    #[unsafe(no_mangle)]
    extern "aapcs" fn __aeabi_fmul(a: u32, b: u32) -> u32 {
        multiply(a, b)
    }
}

#[unsafe(no_mangle)]
#[inline(never)]
extern "aapcs" fn __aeabi_dadd(a: u64, b: u64) -> u64 {
    add(a, b)
}

#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_dsub(a: u64, b: u64) -> u64 {
    __aeabi_dadd(a, b ^ u64::SIGN)
}

#[unsafe(no_mangle)]
extern "aapcs" fn __aeabi_dmul(a: u64, b: u64) -> u64 {
    multiply(a, b)
}
