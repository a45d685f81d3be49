//! The watchdog.

use super::system;
use crate::board::cortex_m::watchdog::{Call, Registers, TwoStage};
use crate::board::register::Register;

// SAFETY: the watchdog's registers of the data sheet, chapter 11; without DMA they cannot break memory safety.
const LOAD: Register = unsafe { Register::at(0x4000_0000) };
const CONTROL: Register = unsafe { Register::at(0x4000_0008) };
const CLEAR: Register = unsafe { Register::at(0x4000_000C) };
const TEST: Register = unsafe { Register::at(0x4000_0418) };
const LOCK: Register = unsafe { Register::at(0x4000_0C00) };

/// It stands still while a debugger holds the processor.
const STALL: u32 = 1 << 8;
/// The number of its interrupt.
const CALL: Call = Call::Own(18);

/// Starts it.
pub(super) fn start(hertz: u32) -> TwoStage {
    TEST.write(STALL);
    let registers = Registers { load: LOAD, control: CONTROL, clear: CLEAR, lock: LOCK };
    TwoStage::start(registers, hertz, CALL, system::reset_by_watchdog())
}
