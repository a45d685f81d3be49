//! The record that is kept across a reset: the scene, and the reason for the reset.
//!
//! It is kept in memory that the start-up code does not initialise, in the format of a message on
//! the serial link. When the board is switched on, this memory contains noise. The frame, length,
//! version and CRC of the message show whether it is intact. If it is not, or if a program that was
//! built for another panel wrote it, the board starts with the first scene.
//!
//! After a reset from outside, by the reset button or a debugger, the board also starts with the
//! first scene, because a fresh start is then wanted.

use serde::{Deserialize, Serialize};

use crate::config::TICK_RATE;
use crate::display::{BUILT_FOR, Controller};
use crate::protocol::{Cause, Decoder, MAX_WIRE, Restarted, Status, encode, read};

/// The memory for a retained record, 141 bytes ([`MAX_WIRE`]). Any contents are possible;
/// [`Record::read`] checks them.
pub type Kept = [u8; MAX_WIRE];

/// The largest number of restarts in a row that play the same scene again. After more the board
/// starts with the first scene, because the scene may be the cause.
///
/// Restarts are in a row if fewer than [`SOUND_FRAMES`] frames are between them. They count even if
/// the user has changed the scene in between.
pub const MOST_RESTARTS: u8 = 3;
/// Earlier restarts no longer count after this number of frames, 3,600, without a restart. This is
/// a minute on a board that draws every frame.
pub const SOUND_FRAMES: u32 = 60 * TICK_RATE;

/// The retained record: the state before a restart, and the reason why the program ended.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The state of the player and of the panel.
    pub played: Status,
    /// The end of the program. It has no cause while the program is running.
    pub end: Restarted,
}

impl Record {
    /// Returns the bytes to keep: a message as on the wire, of the record and [`BUILT_FOR`],
    /// followed by zeros. Every record fits.
    pub fn write(&self) -> Kept {
        let mut kept = [0; MAX_WIRE];
        encode(&(self, BUILT_FOR), &mut kept);
        kept
    }

    /// Returns the record in these bytes; `None` if it is not intact, or if a program with another
    /// version of the protocol or another [`BUILT_FOR`] wrote it. Bytes after the first message are
    /// ignored. The numbers of an intact record, such as its settings, are not checked.
    pub fn read(kept: &Kept) -> Option<Self> {
        let mut decoder = Decoder::default();
        for &byte in kept {
            if let Some(message) = decoder.push(byte) {
                let (record, built_for): (Self, Option<Controller>) =
                    message.ok().and_then(read)?;
                return (built_for == BUILT_FOR).then_some(record);
            }
        }
        None
    }

    /// Returns the record of a restart, with its cause and with the restart counted (at most 255).
    ///
    /// If no cause is recorded, `by_watchdog` is the board's own information about the reset. If
    /// true, the cause is a hang. If false, the reset came from outside, and the result is `None`.
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

    /// Returns true if the restarts in a row are more than [`MOST_RESTARTS`], so that the scene is
    /// not to be played again.
    pub fn is_given_up(&self) -> bool {
        self.end.restarts > MOST_RESTARTS
    }
}

/// The counters for the records that are kept after each frame, in case it is the last.
#[derive(Clone, Copy, Debug, Default)]
pub struct Journal {
    /// The number of restarts in a row.
    restarts: u8,
    /// The number of frames since the last restart.
    frames: u32,
}

impl Journal {
    /// Creates the counters. `restart` is the record of the restart that has just happened, from
    /// [`Record::restart`]; its count, which already includes this restart, is taken over. It is
    /// `None` after a reset from outside or at power-on.
    pub fn new(restart: Option<&Record>) -> Self {
        Self {
            restarts: restart.map_or(0, |restart| restart.end.restarts),
            frames: 0,
        }
    }

    /// Counts a frame and returns the record to keep after it: `played`, the state of the player,
    /// and `step`, the tick of the scene that was shown. The record has no cause, and its registers
    /// are 0. Its count of restarts is that of [`new`](Self::new), and 0 from the call with the
    /// number [`SOUND_FRAMES`] on.
    pub fn note(&mut self, played: Status, step: u64) -> Record {
        self.frames = self.frames.saturating_add(1);
        // After a minute without a restart, earlier restarts no longer count.
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
