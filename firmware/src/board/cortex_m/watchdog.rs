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

pub trait Watchdog {
    /// Restarts the watchdog's time. When it ends, a watchdog with an interrupt reports a hang, and
    /// one without does nothing. Both reset the board after about twice the time.
    fn feed(&mut self);
}

/// The ARM watchdog of two stages (SP805 and similar): it interrupts after its time, and resets the
/// board after twice its time.
#[derive(Debug)]
pub struct TwoStage(Device);

const LOAD: usize = 0x000;
const CONTROL: usize = 0x008;
const CLEAR: usize = 0x00c;
const LOCK: usize = 0xc00;

const ENABLE: u32 = 1 << 1 | 1 << 0;
/// The number that unlocks the other registers; any other number locks them.
const UNLOCK: u32 = 0x1ACC_E551;
const LOCKED: u32 = 1;

/// Unlocks the registers until the watchdog is fed.
pub(in crate::board) fn unlock(device: Device) {
    device.register(LOCK).write(UNLOCK);
}

impl TwoStage {
    /// Starts the watchdog. `call` is the processor's number of its interrupt: [`NMI`], or
    /// [`FIRST`] plus the number in the chip's data sheet.
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

pub(in crate::board) const NMI: u16 = 2;
pub(in crate::board) const FIRST: u16 = 16;

static CALL: AtomicU16 = AtomicU16::new(NMI);

pub(super) fn is_call(number: u32) -> bool {
    number == CALL.load(Ordering::Relaxed).into()
}

fn own() -> Option<Interrupt> {
    CALL.load(Ordering::Relaxed)
        .checked_sub(FIRST)
        .map(Interrupt)
}

static FED: AtomicU32 = AtomicU32::new(0);

/// Returns true if the clock has also counted the watchdog's time since the last feeding. If not,
/// the processor was stopped from outside, such as an emulator that is paused.
pub(super) fn has_ticked() -> bool {
    ticks().wrapping_sub(FED.load(Ordering::Relaxed)) >= WATCHDOG_SECONDS * TICK_RATE - 1
}

/// Makes the watchdog stop while a debugger halts the processor (`true`), or lets it run on.
type Stall = fn(bool);
static STALL: Shared<Stall> = Shared::new(|_| ());

pub(in crate::board) fn stall_by(by: Stall) {
    STALL.with(|stall| *stall = by);
    by(true);
}

pub(super) fn stall(stalls: bool) {
    if let Some(stall) = STALL.with(|stall| *stall) {
        stall(stalls);
    }
}

/// Masks the watchdog's interrupt until the watchdog is fed, so that it does not repeat.
pub(super) fn silence() {
    if let Some(interrupt) = own() {
        NVIC::mask(interrupt);
    }
}
