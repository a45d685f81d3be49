//! The handler of every interrupt that has no handler of its own: it receives bytes of the serial
//! port, or reports the first interrupt of a watchdog.

use core::arch::naked_asm;

use cortex_m_rt::ExceptionFrame;

use super::{crash, watchdog};
use crate::board::serial;

/// Passes on the address of the stacked registers of the interrupted code, and the number of the
/// interrupt.
///
/// # Safety
///
/// Only the processor may call it, through the vector table.
#[unsafe(naked)]
#[unsafe(no_mangle)]
unsafe extern "C" fn DefaultHandler() {
    naked_asm!(
        "mrs r0, msp", // The program and the interrupts have this one stack.
        "mrs r1, ipsr",
        "ldr r2, 0f", // The branch of an M0+ is too short.
        "bx r2",
        ".p2align 2",
        "0: .word {interrupt}",
        interrupt = sym interrupt,
    )
}

extern "C" fn interrupt(interrupted: &ExceptionFrame, number: u32) {
    if watchdog::is_call(number) {
        watchdog::silence();
        crash::hang(interrupted);
    } else {
        serial::receive();
    }
}
