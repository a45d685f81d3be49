//! What resets a board whose main loop no longer finishes frames.
//!
//! It is fed in one place, by the main loop, when a frame has been drawn and sent (`main_loop.rs`). An interrupt would
//! be the wrong one to feed it: the tick's goes on for ever while the program turns in circles.

use core::sync::atomic::{AtomicU16, AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;

use super::clock::ticks;
use super::interrupt::{Interrupt, Shared, unmask};
use crate::board::register::Device;
use crate::config::{TICK_RATE, WATCHDOG_SECONDS};

pub trait Watchdog {
    fn feed(&mut self);
}

/// ARM's watchdog of two stages (SP805 and its sisters): when its time is over it interrupts, and when it is over once
/// more it resets the board.
#[derive(Debug)]
pub struct TwoStage(Device);

/// Its registers: where it counts from, what is on, what begins the time anew, what locks the others.
const LOAD: usize = 0x000;
const CONTROL: usize = 0x008;
const CLEAR: usize = 0x00c;
const LOCK: usize = 0xc00;

/// The interrupt and the reset, on.
const ENABLE: u32 = 1 << 1 | 1 << 0;
/// Writing this opens the other registers, any other number closes them.
const UNLOCK: u32 = 0x1ACC_E551;
const LOCKED: u32 = 1;

/// Opens the registers of such a watchdog until it is fed.
pub(in crate::board) fn unlock(device: Device) {
    device.register(LOCK).write(UNLOCK);
}

impl TwoStage {
    /// Starts it; it counts at `hertz` and interrupts by the `call`, as the processor numbers it.
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
    #[inline(never)] // no second copy
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

/// What the processor calls the interrupt that cannot be masked, and the first of the chip's own.
pub(in crate::board) const NMI: u16 = 2;
pub(in crate::board) const FIRST: u16 = 16;

/// What the processor calls the watchdog's interrupt.
static CALL: AtomicU16 = AtomicU16::new(NMI);

/// Whether the interrupt that the processor calls so is the watchdog's.
pub(super) fn is_call(number: u32) -> bool {
    number == CALL.load(Ordering::Relaxed).into()
}

fn own() -> Option<Interrupt> {
    CALL.load(Ordering::Relaxed)
        .checked_sub(FIRST)
        .map(Interrupt)
}

static FED: AtomicU32 = AtomicU32::new(0);

/// Whether the ticks of the time that it gives have been counted as well. If not, the processor was held up from outside, as an
/// emulator that is stopped for a while is, or has its interrupts off.
pub(super) fn has_ticked() -> bool {
    ticks().wrapping_sub(FED.load(Ordering::Relaxed)) >= WATCHDOG_SECONDS * TICK_RATE - 1
}

/// Makes the board's watchdog stand still while a debugger halts the processor, or lets it go on.
type Stall = fn(bool);
static STALL: Shared<Stall> = Shared::new(|_| ());

/// The watchdog stands still while a debugger halts the processor, from now on until a report.
pub(in crate::board) fn stall_by(by: Stall) {
    STALL.with(|stall| *stall = by);
    by(true);
}

pub(super) fn stall(stalls: bool) {
    if let Some(stall) = STALL.with(|stall| *stall) {
        stall(stalls);
    }
}

/// Keeps its interrupt from coming again and again until it is fed; the one that cannot be masked comes once.
pub(super) fn silence() {
    if let Some(interrupt) = own() {
        NVIC::mask(interrupt);
    }
}
