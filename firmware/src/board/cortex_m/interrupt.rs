//! The enabling of interrupts, and the type for data that they share with the program.

use core::cell::RefCell;

use cortex_m::interrupt::{InterruptNumber, Mutex, free};
use cortex_m::peripheral::NVIC;

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
