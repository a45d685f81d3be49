//! What is said when it is news, and not again and again.

use crate::config::TICK_RATE;

/// A count that wraps. How it has grown is said at most once a second, so that saying it does not make it worse.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ThrottledCounter {
    pub(super) total: u32,
    said: u32,
    tick: u32,
}

impl ThrottledCounter {
    /// Counts from `total` on, at this tick.
    pub(super) fn starting(total: u32, tick: u32) -> Self {
        Self { total, said: total, tick }
    }

    pub(super) fn add(&mut self, count: u32) {
        self.total = self.total.wrapping_add(count);
    }

    /// By how much it has grown, if it has and it is time to say so.
    pub(super) fn news(&mut self, tick: u32) -> Option<u32> {
        let grown = self.total.wrapping_sub(self.said);
        let is_time = grown != 0 && tick.wrapping_sub(self.tick) >= TICK_RATE;
        is_time.then(|| {
            *self = Self::starting(self.total, tick);
            grown
        })
    }
}

/// Whether something that is done again and again fails; said only when it did not fail before.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FaultEdge(bool);

impl FaultEdge {
    pub(super) fn note<E>(&mut self, result: Result<(), E>, say: impl FnOnce(E)) {
        let failed_before = core::mem::replace(&mut self.0, result.is_err());
        if let Err(error) = result
            && !failed_before
        {
            say(error);
        }
    }
}
