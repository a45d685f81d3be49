//! Five buttons, debounced, become commands, or one: by how often it is tapped before it is held.

use crate::config::{
    DEBOUNCE_TICKS, HOLD_TICKS, MOST_TICKS_BETWEEN_TAPS, REPEAT_DELAY_TICKS, REPEAT_PERIOD_TICKS,
};
use crate::protocol::Command;

choice! {
    /// A button.
    Key {
        Up = "up";
        Down = "down";
        Left = "left";
        Right = "right";
        Select = "select";
    }
}

/// A reading of the five buttons; `true` is pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pressed {
    pub up: bool,
    pub down: bool,
    pub left: bool,
    pub right: bool,
    pub select: bool,
}

pub trait Buttons {
    fn read(&mut self) -> Pressed;
}

#[derive(Clone, Copy, Debug, Default)]
pub struct NoButtons;

impl Buttons for NoButtons {
    fn read(&mut self) -> Pressed {
        Pressed::default()
    }
}

/// What up, down, left and right ask for alone, and with select held.
const ARROWS: [[Command; 2]; 4] = [
    [Command::Heavier, Command::TogglePause],
    [Command::Lighter, Command::Step(1)],
    [Command::TurnLeft, Command::PreviousScene],
    [Command::TurnRight, Command::NextScene],
];

/// The five buttons' history.
///
/// | button | alone, repeating | with select held |
/// |---|---|---|
/// | up | next larger mass ratio | stop the scene's time, or let it go on |
/// | down | next smaller mass ratio | one tick, then stop |
/// | left | start angle clockwise | scene before |
/// | right | start angle counter-clockwise | next scene |
///
/// Select alone does for all: let go it asks for a restart, held for [`HOLD_TICKS`] for the next
/// scene, and held after taps for another mass ratio or start angle.
#[derive(Clone, Debug, Default)]
pub struct Controls {
    arrows: [Button; 4],
    select: Button,
    alone: OneButton,
}

impl Controls {
    /// Takes the reading of one tick and returns what it asks for.
    pub fn tick(
        &mut self,
        Pressed {
            up,
            down,
            left,
            right,
            select,
        }: Pressed,
    ) -> impl Iterator<Item = Command> + use<> {
        let select = self.select.tick(select);
        let with_select = self.select.is_held();
        let mut asked = [None; 4];
        let arrows = ARROWS
            .into_iter()
            .zip(&mut self.arrows)
            .zip([up, down, left, right]);
        for (asked, (([alone, held], button), pressed)) in asked.iter_mut().zip(arrows) {
            *asked = match button.tick(pressed) {
                Some(Change::Pressed) if with_select => Some(held),
                Some(Change::Pressed | Change::Repeated) if !with_select => Some(alone),
                _ => None,
            };
        }
        let alone = self.alone.tick(select, asked.iter().any(Option::is_some));
        asked.into_iter().flatten().chain(alone)
    }
}

/// What select asks for when it is held after no tap, one, two, three, four; all but the first repeat.
const HELD: [Command; 5] = [
    Command::NextScene,
    Command::Heavier,
    Command::Lighter,
    Command::TurnRight,
    Command::TurnLeft,
];

/// The select button's history, as far as it is pressed alone.
#[derive(Clone, Debug, Default)]
struct OneButton {
    /// Ticks that it has been held alone; `None` if it is not, or has served for something else.
    held: Option<u8>,
    served: bool,
    taps: usize,
    /// Ticks since the last of them.
    since: u8,
}

impl OneButton {
    /// Takes what the button does in this tick; what that asks for. A tap asks for a restart.
    fn tick(&mut self, change: Option<Change>, with_another: bool) -> Option<Command> {
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
                (self.taps, self.since) = (
                    if tapped {
                        self.taps.saturating_add(1)
                    } else {
                        0
                    },
                    0,
                );
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
        self.held = command
            .filter(|command| *command != Command::NextScene)
            .map(|_| HOLD_TICKS - REPEAT_PERIOD_TICKS);
        command
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Pressed,
    /// Held long enough to count as pressed again.
    Repeated,
    Released,
}

/// One button, repeated while held.
#[derive(Clone, Debug, Default)]
struct Button {
    phase: Phase,
    /// Readings in a row that contradict the phase.
    contradictions: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// Not yet seen released: a line that reads pressed from the first may be stuck or not driven, so it is ignored.
    #[default]
    Unproven,
    Released,
    /// Held, with this many ticks left until it counts as pressed again.
    Held {
        repeats_in: u8,
    },
}

impl Button {
    fn is_held(&self) -> bool {
        matches!(self.phase, Phase::Held { .. })
    }

    fn tick(&mut self, pressed: bool) -> Option<Change> {
        let contradicts = if self.phase == Phase::Unproven {
            !pressed
        } else {
            pressed != self.is_held()
        };
        self.contradictions = if contradicts {
            self.contradictions.saturating_add(1)
        } else {
            0
        };
        if self.contradictions >= DEBOUNCE_TICKS {
            self.contradictions = 0;
            let proven = self.phase != Phase::Unproven;
            self.phase = if pressed {
                Phase::Held {
                    repeats_in: REPEAT_DELAY_TICKS,
                }
            } else {
                Phase::Released
            };
            return proven.then_some(if pressed {
                Change::Pressed
            } else {
                Change::Released
            });
        }
        let Phase::Held { repeats_in } = &mut self.phase else {
            return None;
        };
        *repeats_in = repeats_in.saturating_sub(1);
        (*repeats_in == 0).then(|| {
            *repeats_in = REPEAT_PERIOD_TICKS;
            Change::Repeated
        })
    }
}
