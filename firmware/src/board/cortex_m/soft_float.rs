//! [`soft_float`](crate::soft_float) under the names by which the compiler calls for it. Its own library's functions give
//! way to these: they take half as long again (leave this module out, and `cargo count` shows it).
//!
//! Source: Run-time ABI for the Arm architecture, 4.1.2: arguments and results are in the integer registers, also where
//! there is a floating-point unit.

use crate::soft_float::{add, multiply, negative};

macro_rules! named {
    ($bits:ident: $add:ident, $subtract:ident, $multiply:ident) => {
        // SAFETY: the names are those of functions of the compiler's library, which gives way to these, and these do what
        // the names say: the standard's operations on the bits of the standard's formats.
        #[unsafe(no_mangle)]
        #[inline(never)]
        extern "aapcs" fn $add(a: $bits, b: $bits) -> $bits {
            add(a, b)
        }

        // SAFETY: as above.
        #[unsafe(no_mangle)]
        extern "aapcs" fn $subtract(a: $bits, b: $bits) -> $bits {
            $add(a, negative(b))
        }

        // SAFETY: as above.
        #[unsafe(no_mangle)]
        extern "aapcs" fn $multiply(a: $bits, b: $bits) -> $bits {
            multiply(a, b)
        }
    };
}

#[cfg(target_abi = "eabi")] // where there is no floating-point unit
named!(u32: __aeabi_fadd, __aeabi_fsub, __aeabi_fmul);
named!(u64: __aeabi_dadd, __aeabi_dsub, __aeabi_dmul);
