//! What is kept across a reset: what was played, and why it ended.
//!
//! It is kept in memory that the start-up code leaves alone, as a message of the serial link would be sent. That memory
//! holds noise when the board is switched on; what is no intact message, by its frame, length, version and CRC, is noise,
//! and the board starts as at the first time. So it does after a reset from outside, by its button or by a debugger:
//! whoever does that wants a fresh start.

use serde::{Deserialize, Serialize};

use crate::config::TICK_RATE;
use crate::protocol::{Cause, Decoder, MAX_WIRE, Restarted, Status, encode, read};

pub type Kept = [u8; MAX_WIRE];

/// A scene may be what ends the board each time: after so many restarts in a row it starts with the first scene.
pub const MOST_RESTARTS: u8 = 3;
/// So many frames without a restart, a minute's worth, and those before count no longer.
pub const SOUND_FRAMES: u32 = 60 * TICK_RATE;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub played: Status,
    /// How it ended; with no cause as long as it has not.
    pub end: Restarted,
}

impl Record {
    pub fn write(&self) -> Kept {
        let mut kept = [0; MAX_WIRE];
        encode(self, &mut kept);
        kept
    }

    /// `None` unless it is intact.
    pub fn read(kept: &Kept) -> Option<Self> {
        let mut decoder = Decoder::default();
        for &byte in kept {
            if let Some(message) = decoder.push(byte) {
                return message.ok().and_then(read);
            }
        }
        None
    }

    /// The restart that it tells of, counted; `None` of a reset from outside. Where nothing noted a cause, it may have been the
    /// watchdog, by the board's own register.
    pub fn restart(self, by_watchdog: bool) -> Option<Self> {
        let cause = Some(self.end.cause.or(by_watchdog.then_some(Cause::Hang))?);
        Some(Self {
            end: Restarted {
                cause,
                restarts: self.end.restarts.saturating_add(1),
                ..self.end
            },
            ..self
        })
    }

    /// Whether what was played has been tried often enough.
    pub fn is_given_up(&self) -> bool {
        self.end.restarts > MOST_RESTARTS
    }
}

/// What is kept after each frame, in case it is the last.
#[derive(Clone, Copy, Debug, Default)]
pub struct Journal {
    /// In a row, so far.
    restarts: u8,
    /// Frames since the last.
    frames: u32,
}

impl Journal {
    pub fn new(restart: Option<&Record>) -> Self {
        Self {
            restarts: restart.map_or(0, |restart| restart.end.restarts),
            frames: 0,
        }
    }

    /// Returns the record to keep after a frame: what is played, and the step that was shown.
    pub fn note(&mut self, played: Status, step: u64) -> Record {
        self.frames = self.frames.saturating_add(1);
        if self.frames >= SOUND_FRAMES {
            self.restarts = 0;
        }
        Record {
            played,
            end: Restarted {
                restarts: self.restarts,
                scene: played.scene,
                step,
                ..Restarted::default()
            },
        }
    }
}
