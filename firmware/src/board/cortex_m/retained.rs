//! The memory that is kept across a reset, and who writes it: the main loop after each frame, a crash at the end.

use core::hint::black_box;
use core::sync::atomic::{AtomicU8, Ordering};

use crate::app::{Cause, Kept, WarmRestart, read};
use crate::protocol::{MAX_WIRE, Message, Restarted, Status, encode};

// SAFETY: start-up leaves this section alone, and what stands there is bytes.
#[unsafe(link_section = ".uninit.played")]
static PLAYED: Memory = Memory::new();
/// How it ended; with no cause as long as it has not.
// SAFETY: as above.
#[unsafe(link_section = ".uninit.end")]
static END: Memory = Memory::new();

/// A watchdog's interrupt may write in the middle of the main loop's writing: what comes of two at once is found out by
/// the message's check.
struct Memory([AtomicU8; MAX_WIRE]);

impl Memory {
    const fn new() -> Self {
        Self([const { AtomicU8::new(0) }; MAX_WIRE])
    }

    /// The bytes, of which the compiler must assume nothing: what is read here was written by a program that has ended, and
    /// what is written is for one yet to come.
    fn bytes(&self) -> &[AtomicU8; MAX_WIRE] {
        black_box(&self.0)
    }

    fn read(&self) -> Kept {
        self.bytes().each_ref().map(|byte| byte.load(Ordering::Relaxed))
    }

    fn write<M: Message>(&self, message: &M) {
        let mut kept = [0; MAX_WIRE];
        encode(message, &mut kept);
        for (place, byte) in self.bytes().iter().zip(kept) {
            place.store(byte, Ordering::Relaxed);
        }
    }
}

/// What was kept across the last reset, if that was no planned one.
pub fn recall(by_watchdog: bool) -> Option<WarmRestart> {
    WarmRestart::recall(&PLAYED.read(), &END.read(), by_watchdog)
}

/// Keeps what is played, if it is new, and where it stands, in case this frame is the last.
#[inline(never)]
pub fn keep((played, end): (Option<Status>, Restarted)) {
    if let Some(played) = played {
        PLAYED.write(&played);
    }
    END.write(&end);
}

#[inline(never)]
pub fn last() -> Option<Restarted> {
    read(&END.read())
}

#[inline(never)]
pub fn end(cause: Cause, pc: u32, lr: u32, cfsr: u32) {
    END.write(&Restarted { cause: cause.code(), pc, lr, cfsr, ..last().unwrap_or_default() });
}
