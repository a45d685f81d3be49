//! The watchdog. The lock of its registers is closed by the next feeding.

use crate::board::cortex_m::watchdog::{self, FIRST, TwoStage};
use crate::board::register::{Device, Register};

// SAFETY: the watchdog of the data sheet, chapter 11; without DMA it cannot break memory safety.
const WATCHDOG: Device = unsafe { Device::at(0x4000_0000) };
const TEST: Register = WATCHDOG.register(0x418);

/// It stands still while a debugger holds the processor.
const STALL: u32 = 1 << 8;
const CALL: u16 = FIRST + 18;

fn stall(stalls: bool) {
    watchdog::unlock(WATCHDOG);
    TEST.write(if stalls { STALL } else { 0 });
}

pub(super) fn start(hertz: u32) -> TwoStage {
    watchdog::stall_by(stall);
    TwoStage::start(WATCHDOG, hertz, CALL)
}
