//! What resets a board whose main loop no longer finishes pictures.
//!
//! It is fed in one place, by the main loop, when a picture has been drawn and sent (`main_loop.rs`). An interrupt would
//! be the wrong one to feed it: the tick's goes on for ever while the program turns in circles.

use super::register::Register;
use crate::config::WATCHDOG_SECONDS;

/// What the main loop needs of it.
pub trait Watchdog {
    /// Begins its time anew.
    fn feed(&mut self);

    /// Whether the board's own register says that it caused the last reset.
    fn has_reset(&self) -> bool;
}

/// ARM's watchdog of two stages (SP805 and its sisters): when its time is over it interrupts, and when it is over once
/// more it resets the board.
#[derive(Debug)]
pub struct TwoStage {
    clear: Register,
    lock: Register,
    /// Allows the interrupt again.
    rearm: fn(),
    has_reset: bool,
}

/// Its registers.
pub(super) struct Registers {
    pub load: Register,
    pub control: Register,
    pub clear: Register,
    pub lock: Register,
}

/// The interrupt and the reset, on.
const ENABLE: u32 = 1 << 1 | 1 << 0;
/// Writing this opens the other registers, any other number closes them.
const UNLOCK: u32 = 0x1ACC_E551;
const LOCKED: u32 = 1;

impl TwoStage {
    /// Starts it; it counts at `hertz`.
    pub(super) fn start(registers: Registers, hertz: u32, rearm: fn(), has_reset: bool) -> Self {
        let Registers { load, control, clear, lock } = registers;
        lock.write(UNLOCK);
        load.write(hertz.saturating_mul(WATCHDOG_SECONDS));
        control.write(ENABLE);
        let mut watchdog = Self { clear, lock, rearm, has_reset };
        watchdog.feed();
        watchdog
    }
}

impl Watchdog for TwoStage {
    fn feed(&mut self) {
        self.lock.write(UNLOCK);
        self.clear.write(1);
        self.lock.write(LOCKED);
        (self.rearm)();
    }

    fn has_reset(&self) -> bool {
        self.has_reset
    }
}
