//! The watchdog.

use super::system;
use crate::board::cortex_m::watchdog::{self, Call, Registers, TwoStage, UNLOCK};
use crate::board::register::{Device, Register};

// SAFETY: the watchdog of the data sheet, chapter 11; without DMA it cannot break memory safety.
const WATCHDOG: Device = unsafe { Device::at(0x4000_0000) };
const TEST: Register = WATCHDOG.register(0x418);
const LOCK: Register = WATCHDOG.register(0xc00);

/// It stands still while a debugger holds the processor.
const STALL: u32 = 1 << 8;
const CALL: Call = Call::Own(18);

/// The lock of its registers, which this opens, is closed by the next feeding.
fn stall(stalls: bool) {
    LOCK.write(UNLOCK);
    TEST.write(if stalls { STALL } else { 0 });
}

pub(super) fn start(hertz: u32) -> TwoStage {
    watchdog::stall_by(stall);
    TwoStage::start(Registers::of(WATCHDOG), hertz, CALL, system::reset_by_watchdog())
}
