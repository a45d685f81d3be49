//! The parts that every Cortex-M has.

pub mod clock;

pub(super) mod crash;
pub(super) mod instruments;
pub(super) mod interrupt;
pub(super) mod retained;
pub(super) mod watchdog;

mod handler;
#[cfg(armv6m)]
mod long_product;
mod stack;
mod tick_timer;

use core::str;

use cortex_m_semihosting::{nr, syscall1};

pub(super) use instruments::start;

/// Returns the command line that a debugger, or QEMU, has for the program; `None` if there is no
/// debugger.
pub fn command_line(buffer: &mut [u8]) -> Option<&str> {
    let mut block = [buffer.as_mut_ptr() as usize, buffer.len()];
    // SAFETY: SYS_GET_CMDLINE takes the address and length of a buffer. It writes a string of at
    // most that length into it, and the length of the string into the second word. Both outlive the
    // call, and no other code refers to them.
    let status = unsafe { syscall1(nr::GET_CMDLINE, block.as_mut_ptr() as usize) };
    let length = block[1];
    if status == 0 {
        str::from_utf8(buffer.get(..length)?).ok()
    } else {
        None
    }
}
