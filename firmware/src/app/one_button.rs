//! All that one button can ask for, by how often it is tapped before it is held.

use crate::app::Command;
use crate::app::button::Change;
use crate::config::{HOLD_TICKS, MOST_TICKS_BETWEEN_TAPS, REPEAT_PERIOD_TICKS};

/// What the button asks for when it is held after no tap, one, two, three, four; all but the first repeat.
const HELD: [Command; 5] =
    [Command::NextScene, Command::Heavier, Command::Lighter, Command::TurnRight, Command::TurnLeft];

#[derive(Clone, Debug, Default)]
pub struct OneButton {
    /// Ticks that it has been held alone; `None` if it is not, or has served for something else.
    held: Option<u8>,
    served: bool,
    taps: usize,
    /// Ticks since the last of them.
    since: u8,
}

impl OneButton {
    /// Takes what the button does in this tick; what that asks for. A tap asks for a restart.
    pub fn tick(&mut self, change: Option<Change>, with_another: bool) -> Option<Command> {
        self.since = self.since.saturating_add(1);
        match change {
            Some(Change::Pressed) => {
                if self.since > MOST_TICKS_BETWEEN_TAPS {
                    self.taps = 0;
                }
                (self.held, self.served) = (Some(0), false);
            }
            Some(Change::Released) => {
                let tapped = self.held.take().is_some() && !self.served;
                (self.taps, self.since) = (if tapped { self.taps.saturating_add(1) } else { 0 }, 0);
                return tapped.then_some(Command::Restart);
            }
            Some(Change::Repeated) | None => {}
        }
        if with_another {
            self.held = None;
        }
        let held = self.held.as_mut()?;
        *held = held.saturating_add(1);
        if *held < HOLD_TICKS {
            return None;
        }
        self.served = true;
        let command = HELD.get(self.taps).copied();
        self.held = command.filter(|command| *command != Command::NextScene).map(|_| HOLD_TICKS - REPEAT_PERIOD_TICKS);
        command
    }
}
