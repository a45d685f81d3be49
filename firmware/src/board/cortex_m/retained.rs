//! The memory that outlives a reset, and who writes it: the main loop after each frame, a crash at the end.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use crate::app::warm_restart::{Cause, Kept, WarmRestart, read};
use crate::protocol::{MAX_WIRE, Message, Restarted, Status, encode};

/// What is played.
#[unsafe(link_section = ".uninit.played")]
static PLAYED: Memory = Memory::new();
/// How it ended; with no cause as long as it has not.
#[unsafe(link_section = ".uninit.end")]
static END: Memory = Memory::new();

struct Memory(UnsafeCell<MaybeUninit<Kept>>);

// SAFETY: bytes are read and written one by one, and whatever comes of two at once is found out by the check.
unsafe impl Sync for Memory {}

impl Memory {
    const fn new() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    /// Volatile, as what is written here is for a program yet to come, and what is read by one that has ended.
    fn read(&self) -> Kept {
        let bytes: *const u8 = self.0.get().cast();
        // SAFETY: within the array; memory holds some byte there, though the compiler does not know which.
        core::array::from_fn(|index| unsafe { bytes.add(index).read_volatile() })
    }

    fn write<M: Message>(&self, message: &M) {
        let mut kept = [0; MAX_WIRE];
        encode(message, &mut kept);
        let bytes: *mut u8 = self.0.get().cast();
        for (index, byte) in kept.into_iter().enumerate() {
            // SAFETY: within the array.
            unsafe { bytes.add(index).write_volatile(byte) };
        }
    }
}

/// What outlived the last reset, if that was no planned one.
pub fn recall(by_watchdog: bool) -> Option<WarmRestart> {
    WarmRestart::recall(&PLAYED.read(), &END.read(), by_watchdog)
}

/// Keeps what is played, in case this frame is the last.
pub fn keep((played, end): (Status, Restarted)) {
    PLAYED.write(&played);
    END.write(&end);
}

/// Where things stand, if that is known.
#[inline(never)]
pub fn last() -> Option<Restarted> {
    read(&END.read())
}

/// Keeps how it ended.
#[inline(never)]
pub fn end(cause: Cause, pc: u32, lr: u32, cfsr: u32) {
    END.write(&Restarted { cause: cause.code(), pc, lr, cfsr, ..last().unwrap_or_default() });
}
