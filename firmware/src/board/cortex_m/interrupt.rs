//! The handler of every interrupt that has no handler of its own: it receives bytes of the serial
//! port, or reports the first interrupt of a watchdog. Also the type for data that an interrupt
//! shares.

use core::arch::naked_asm;
use core::cell::RefCell;

use cortex_m::interrupt::{InterruptNumber, Mutex, free};
use cortex_m::peripheral::NVIC;
use cortex_m_rt::ExceptionFrame;

use super::{crash, watchdog};
use crate::board::serial;

pub(in crate::board) struct Shared<T>(Mutex<RefCell<T>>);

impl<T> Shared<T> {
    pub const fn new(value: T) -> Self {
        Self(Mutex::new(RefCell::new(value)))
    }

    /// Calls `act` with the data, with interrupts off. Returns `None` if `act` of the same data is
    /// in progress.
    pub fn with<R>(&self, act: impl FnOnce(&mut T) -> R) -> Option<R> {
        free(|token| {
            self.0
                .borrow(token)
                .try_borrow_mut()
                .ok()
                .map(|mut shared| act(&mut shared))
        })
    }
}

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

/// An interrupt of the chip, by its number in the data sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::board) struct Interrupt(pub u16);

// SAFETY: boards use only numbers of their chip.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self.0
    }
}

/// Enables an interrupt of the chip in the processor.
pub(in crate::board) fn unmask(interrupt: impl InterruptNumber) {
    // SAFETY: no critical section relies on a masked interrupt.
    unsafe { NVIC::unmask(interrupt) };
}
