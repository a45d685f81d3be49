//! What is kept across a reset: what was played, and why it ended.
//!
//! It is kept in memory that the start-up code leaves alone, as two messages of the serial link just as they would be
//! sent. That memory holds noise when the board is switched on; what is no intact message, by its frame, length, version
//! and CRC, is noise, and the board starts as at the first time. So it does after a reset from outside, by its button or by
//! a debugger: whoever does that wants a fresh start.

use core::fmt;

use crate::app::Player;
use crate::config::TICK_RATE;
use crate::protocol::choice;
use crate::protocol::{Decoder, MAX_WIRE, Message, Restarted, Status};
use crate::scenes::SceneName;

pub type Kept = [u8; MAX_WIRE];

/// A scene may be what ends the board each time: after so many restarts in a row it starts with the first scene.
pub const MOST_RESTARTS: u8 = 3;
/// So many frames without a restart, a minute's worth, and those before count no longer.
pub const SOUND_FRAMES: u32 = 60 * TICK_RATE;

choice! {
    /// Why the board restarted.
    Cause {
        /// No frame was finished for too long.
        Hang = 1, "hang";
        /// The program found itself in a state that cannot be.
        Panic = 2, "panic";
        /// The processor could not go on.
        Fault = 3, "fault";
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmRestart {
    /// What was played; `None` if it has been tried [often enough](MOST_RESTARTS).
    pub played: Option<Status>,
    pub end: Restarted,
    pub cause: Cause,
}

impl WarmRestart {
    /// From the two messages kept. Where nothing noted a cause, it may have been the watchdog, by the board's own register.
    pub fn recall(played: &Kept, end: &Kept, by_watchdog: bool) -> Option<Self> {
        let (played, end): (Status, Restarted) = (read(played)?, read(end)?);
        let cause = Cause::from_code(end.cause).or(by_watchdog.then_some(Cause::Hang))?;
        let restarts = end.restarts.saturating_add(1);
        Some(Self {
            played: (restarts <= MOST_RESTARTS).then_some(played),
            end: Restarted { cause: cause.code(), restarts, ..end },
            cause,
        })
    }
}

/// The message kept, if it is intact and an `M`.
pub fn read<M: Message>(kept: &Kept) -> Option<M> {
    let mut decoder = Decoder::default();
    for &byte in kept {
        if let Some(message) = decoder.push(byte) {
            return message.ok().filter(|(kind, _)| *kind == M::KIND).and_then(|(_, fields)| M::read(fields));
        }
    }
    None
}

/// What is kept after each frame, in case it is the last.
#[derive(Clone, Copy, Debug, Default)]
pub struct Journal {
    played: Option<Status>,
    /// In a row, so far.
    restarts: u8,
    /// Frames since the last.
    frames: u32,
}

impl Journal {
    pub fn new(restart: Option<&WarmRestart>) -> Self {
        Self { restarts: restart.map_or(0, |restart| restart.end.restarts), ..Self::default() }
    }

    /// What to keep of `player`, which has just been shown: what is played, if that is not kept already, and where it stands.
    pub fn note(&mut self, player: &Player) -> (Option<Status>, Restarted) {
        self.frames = self.frames.saturating_add(1);
        if self.frames >= SOUND_FRAMES {
            self.restarts = 0;
        }
        let (scene, step) = (player.name().code(), player.report().step as u32);
        let status = player.status(0);
        let is_new = self.played.replace(status) != Some(status);
        (is_new.then_some(status), Restarted { restarts: self.restarts, scene, step, ..Restarted::default() })
    }
}

#[derive(Clone, Copy, Debug)]
pub struct LastShown(pub Option<Restarted>);

impl fmt::Display for LastShown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0.and_then(|last| Some((SceneName::from_code(last.scene)?, last.step))) {
            Some((scene, step)) => write!(f, "scene {}, step {step}", scene.name()),
            None => write!(f, "no scene yet"),
        }
    }
}
