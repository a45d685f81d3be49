//! The watchdog.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;

use super::system;
use crate::board::register::Register;
use crate::board::watchdog::{Registers, TwoStage};

// SAFETY: the watchdog's registers of the data sheet, chapter 11; without DMA they cannot break memory safety.
const LOAD: Register = unsafe { Register::at(0x4000_0000) };
const CONTROL: Register = unsafe { Register::at(0x4000_0008) };
const CLEAR: Register = unsafe { Register::at(0x4000_000C) };
const TEST: Register = unsafe { Register::at(0x4000_0418) };
const LOCK: Register = unsafe { Register::at(0x4000_0C00) };

/// It stands still while a debugger holds the processor.
const STALL: u32 = 1 << 8;
/// The number of its interrupt.
pub(in crate::board) const INTERRUPT: u16 = 18;

/// Starts it.
pub(super) fn start(hertz: u32) -> TwoStage {
    TEST.write(STALL);
    let registers = Registers { load: LOAD, control: CONTROL, clear: CLEAR, lock: LOCK };
    TwoStage::start(registers, hertz, rearm, system::reset_by_watchdog())
}

/// Lets its interrupt through.
fn rearm() {
    NVIC::unpend(Interrupt);
    // SAFETY: no critical section relies on this interrupt being masked.
    unsafe { NVIC::unmask(Interrupt) };
}

/// Keeps its interrupt from coming again and again until it is fed.
pub(in crate::board) fn silence() {
    NVIC::mask(Interrupt);
}

#[derive(Clone, Copy)]
struct Interrupt;

// SAFETY: it is the watchdog's number on this chip, below the 64 that it has.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        INTERRUPT
    }
}
