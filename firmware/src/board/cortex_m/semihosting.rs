//! What a debugger, or QEMU, offers to any Cortex-M.

use core::str;

use cortex_m_semihosting::nr;

/// The command line that the debugger has for the program; `None` if it does not fit `buffer` or is not text.
pub fn command_line(buffer: &mut [u8]) -> Option<&str> {
    let mut block = [buffer.as_mut_ptr() as usize, buffer.len()];
    // SAFETY: SYS_GET_CMDLINE takes the address and length of a buffer, writes a string of at most that length into it
    // and the string's length into the second word; both outlive the call and nothing else refers to them.
    let status = unsafe { cortex_m_semihosting::syscall1(nr::GET_CMDLINE, block.as_mut_ptr() as usize) };
    let length = block[1];
    if status == 0 { str::from_utf8(buffer.get(..length)?).ok() } else { None }
}
