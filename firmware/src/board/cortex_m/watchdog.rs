//! The watchdog, which resets a board whose main loop no longer finishes frames.
//!
//! It is fed in one place, by the main loop, when a frame has been drawn and sent (`main_loop.rs`).
//! An interrupt must not feed it, because the tick's interrupt continues while the program is in an
//! endless loop.

use core::sync::atomic::{AtomicU16, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;

use super::clock::ticks;
use super::interrupt::{Interrupt, Shared, unmask};
use crate::board::register::Device;
use crate::config::{TICK_RATE, WATCHDOG_SECONDS};

/// A watchdog.
pub trait Watchdog {
    /// Restarts the watchdog's time, [`WATCHDOG_SECONDS`] (1 s). When it ends, a watchdog with an
    /// interrupt reports a hang, and one without does nothing. Both reset the board after about
    /// twice the time.
    fn feed(&mut self);
}

/// The ARM watchdog of two stages (SP805 and similar). When its time, [`WATCHDOG_SECONDS`] (1 s),
/// is over it interrupts. When the same time is over again without a feeding, it resets the board.
#[derive(Debug)]
pub struct TwoStage(Device);

/// The registers: the start of the count, the control bits, the restart of the count, and the lock
/// of the others.
const LOAD: usize = 0x000;
const CONTROL: usize = 0x008;
const CLEAR: usize = 0x00c;
const LOCK: usize = 0xc00;

/// The interrupt and the reset are on.
const ENABLE: u32 = 1 << 1 | 1 << 0;
/// The number that unlocks the other registers; any other number locks them.
const UNLOCK: u32 = 0x1ACC_E551;
const LOCKED: u32 = 1;

/// Unlocks the registers of a watchdog ([`TwoStage`]) until it is fed. Without that, writing them
/// has no effect.
pub(in crate::board) fn unlock(device: Device) {
    device.register(LOCK).write(UNLOCK);
}

impl TwoStage {
    /// Starts the watchdog, feeds it, and unmasks its interrupt. Not checked: the device is such a
    /// watchdog, powered, and counts at `hertz`, Hz. A smaller number shortens its time, and 0 ends
    /// it at once. `call` is the processor's number of its interrupt: [`NMI`], or [`FIRST`] plus
    /// the number in the chip's data sheet.
    pub(in crate::board) fn start(device: Device, hertz: u32, call: u16) -> Self {
        CALL.store(call, Ordering::Relaxed);
        unlock(device);
        device
            .register(LOAD)
            .write(hertz.saturating_mul(WATCHDOG_SECONDS));
        device.register(CONTROL).write(ENABLE);

        let mut watchdog = Self(device);
        watchdog.feed();
        watchdog
    }
}

impl Watchdog for TwoStage {
    fn feed(&mut self) {
        unlock(self.0);
        self.0.register(CLEAR).write(1);
        self.0.register(LOCK).write(LOCKED);
        FED.store(ticks(), Ordering::Relaxed);
        if let Some(interrupt) = own() {
            NVIC::unpend(interrupt);
            unmask(interrupt);
        }
    }
}

/// The processor's number of the interrupt that cannot be masked.
pub(in crate::board) const NMI: u16 = 2;
/// The processor's number of the chip's interrupt 0.
pub(in crate::board) const FIRST: u16 = 16;

/// The processor's number of the watchdog's interrupt.
static CALL: AtomicU16 = AtomicU16::new(NMI);

/// Returns true if the watchdog's interrupt has this processor's number. It is [`NMI`] until a
/// [`TwoStage`] is started.
pub(super) fn is_call(number: u32) -> bool {
    number == CALL.load(Ordering::Relaxed).into()
}

/// Returns the watchdog's interrupt; `None` if it cannot be masked.
fn own() -> Option<Interrupt> {
    CALL.load(Ordering::Relaxed)
        .checked_sub(FIRST)
        .map(Interrupt)
}

/// The tick of the last feeding.
static FED: AtomicU32 = AtomicU32::new(0);

/// Returns true if the clock has also counted the watchdog's time, less one tick (59 ticks), since
/// the last feeding of a [`TwoStage`]. If not, the processor was stopped from outside, such as an
/// emulator that is paused, or has its interrupts off.
pub(super) fn has_ticked() -> bool {
    ticks().wrapping_sub(FED.load(Ordering::Relaxed)) >= WATCHDOG_SECONDS * TICK_RATE - 1
}

/// A function that makes the watchdog stop while a debugger halts the processor (`true`), or lets
/// it run on (`false`).
type Stall = fn(bool);
static STALL: Shared<Stall> = Shared::new(|_| ());

/// Sets the function that [`stall`] calls, and calls it with `true`. With `true` it makes the
/// watchdog stop while a debugger halts the processor; with `false` it lets the watchdog run on,
/// which a report does. A later call replaces the function.
pub(in crate::board) fn stall_by(by: Stall) {
    STALL.with(|stall| *stall = by);
    by(true);
}

/// Makes the watchdog stop while a debugger halts the processor (`true`), or lets it run on
/// (`false`), by the function of [`stall_by`]; without one does nothing.
pub(super) fn stall(stalls: bool) {
    if let Some(stall) = STALL.with(|stall| *stall) {
        stall(stalls);
    }
}

/// Masks the watchdog's interrupt until the watchdog is fed, so that it does not repeat. The
/// interrupt that cannot be masked comes only once.
pub(super) fn silence() {
    if let Some(interrupt) = own() {
        NVIC::mask(interrupt);
    }
}
