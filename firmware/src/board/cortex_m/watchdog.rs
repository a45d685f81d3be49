//! What resets a board whose main loop no longer finishes frames.
//!
//! It is fed in one place, by the main loop, when a frame has been drawn and sent (`main_loop.rs`). An interrupt would
//! be the wrong one to feed it: the tick's goes on for ever while the program turns in circles.

use core::cell::Cell;
use core::sync::atomic::{AtomicU16, AtomicU32, Ordering};

use cortex_m::interrupt::{Mutex, free};
use cortex_m::peripheral::NVIC;

use super::clock::ticks;
use super::interrupt::Interrupt;
use crate::board::register::{Device, Register};
use crate::config::{TICK_RATE, WATCHDOG_SECONDS};

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
    has_reset: bool,
}

/// Its interrupt: one of the chip's own, or the one that cannot be masked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::board) enum Call {
    Own(u16),
    Nmi,
}

pub(in crate::board) struct Registers {
    load: Register,
    control: Register,
    clear: Register,
    lock: Register,
}

impl Registers {
    /// Where ARM puts them.
    pub(in crate::board) const fn of(device: Device) -> Self {
        Self {
            load: device.register(0x000),
            control: device.register(0x008),
            clear: device.register(0x00c),
            lock: device.register(0xc00),
        }
    }
}

/// The interrupt and the reset, on.
const ENABLE: u32 = 1 << 1 | 1 << 0;
/// Writing this opens the other registers, any other number closes them.
pub(in crate::board) const UNLOCK: u32 = 0x1ACC_E551;
const LOCKED: u32 = 1;

impl TwoStage {
    /// Starts it; it counts at `hertz`.
    pub(in crate::board) fn start(registers: Registers, hertz: u32, call: Call, has_reset: bool) -> Self {
        let Registers { load, control, clear, lock } = registers;
        call.note();
        lock.write(UNLOCK);
        load.write(hertz.saturating_mul(WATCHDOG_SECONDS));
        control.write(ENABLE);
        let mut watchdog = Self { clear, lock, has_reset };
        watchdog.feed();
        watchdog
    }
}

impl Watchdog for TwoStage {
    fn feed(&mut self) {
        self.lock.write(UNLOCK);
        self.clear.write(1);
        self.lock.write(LOCKED);
        FED.store(ticks(), Ordering::Relaxed);
        rearm();
    }

    fn has_reset(&self) -> bool {
        self.has_reset
    }
}

/// What the processor calls the interrupt that cannot be masked, and the first of the chip's own.
const NMI: u16 = 2;
const FIRST: u16 = 16;

/// What the processor calls the watchdog's interrupt.
static CALL: AtomicU16 = AtomicU16::new(NMI);

impl Call {
    fn note(self) {
        CALL.store(self.number(), Ordering::Relaxed);
    }

    fn number(self) -> u16 {
        match self {
            Self::Own(interrupt) => interrupt.wrapping_add(FIRST),
            Self::Nmi => NMI,
        }
    }

    fn noted() -> Self {
        CALL.load(Ordering::Relaxed).checked_sub(FIRST).map_or(Self::Nmi, Self::Own)
    }
}

/// Whether the interrupt that the processor calls so is the watchdog's.
pub(super) fn is_call(number: u32) -> bool {
    number == Call::noted().number().into()
}

/// The tick when it was last fed.
static FED: AtomicU32 = AtomicU32::new(0);

/// Whether the ticks of the time that it gives have been counted as well. If not, the processor was held up from outside, as an
/// emulator that is stopped for a while is, or has its interrupts off.
pub(super) fn has_ticked() -> bool {
    ticks().wrapping_sub(FED.load(Ordering::Relaxed)) >= WATCHDOG_SECONDS * TICK_RATE - 1
}

/// Makes the board's watchdog stand still while a debugger halts the processor, or lets it go on.
type Stall = fn(bool);
static STALL: Mutex<Cell<Stall>> = Mutex::new(Cell::new(|_| ()));

/// The watchdog stands still while a debugger halts the processor, from now on until a report.
pub(in crate::board) fn stall_by(stall: Stall) {
    free(|token| STALL.borrow(token).set(stall));
    stall(true);
}

/// Whether it does so.
pub(super) fn stall(stalls: bool) {
    free(|token| STALL.borrow(token).get())(stalls);
}

/// Keeps its interrupt from coming again and again until it is fed; the one that cannot be masked comes once.
pub(super) fn silence() {
    if let Call::Own(interrupt) = Call::noted() {
        NVIC::mask(Interrupt(interrupt));
    }
}

/// Lets its interrupt through.
fn rearm() {
    if let Call::Own(interrupt) = Call::noted() {
        NVIC::unpend(Interrupt(interrupt));
        Interrupt(interrupt).unmask();
    }
}
