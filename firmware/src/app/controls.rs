//! The controls: five debounced buttons, or a single one, become commands.

use crate::config::{
    DEBOUNCE_TICKS, HOLD_TICKS, MOST_TICKS_BETWEEN_TAPS, REPEAT_DELAY_TICKS, REPEAT_PERIOD_TICKS,
};
use crate::protocol::Command;

choice! {
    Key {
        Up = "up";
        Down = "down";
        Left = "left";
        Right = "right";
        Select = "select";
    }
}

/// Not debounced; `true` means pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pressed {
    pub up: bool,
    pub down: bool,
    pub left: bool,
    pub right: bool,
    pub select: bool,
    /// A, B, X and Y of a panel with buttons.
    pub letters: [bool; 4],
}

pub trait Buttons {
    /// Returns the levels of the buttons now, without waiting.
    fn read(&mut self) -> Pressed;
}

#[derive(Clone, Copy, Debug, Default)]
pub struct NoButtons;

impl Buttons for NoButtons {
    fn read(&mut self) -> Pressed {
        Pressed::default()
    }
}

/// The commands of up, down, left and right: alone, and with select held.
const ARROWS: [[Command; 2]; 4] = [
    [Command::Heavier, Command::TogglePause],
    [Command::Lighter, Command::Step(1)],
    [Command::TurnLeft, Command::PreviousScene],
    [Command::TurnRight, Command::NextScene],
];

/// The commands of the buttons A, B, X and Y.
const LETTERS: [Command; 4] = [
    Command::PreviousScene,
    Command::NextScene,
    Command::TogglePause,
    Command::Restart,
];

/// The state of the buttons, from readings of one tick to commands.
///
/// A button has no effect until it has been released once.
///
/// | button | alone, repeating | with select held |
/// |---|---|---|
/// | up | next larger mass ratio | pause the scene, or let it continue |
/// | down | next smaller mass ratio | advance one tick, then pause |
/// | left | start angle clockwise | previous scene |
/// | right | start angle counter-clockwise | next scene |
///
/// A board with the select button alone can do the most important things. A tap restarts the scene.
/// Holding it selects the next scene; after one, two, three or four taps it is instead a heavier
/// bob 2, a lighter one, a turn to the right or to the left.
#[derive(Clone, Debug, Default)]
pub struct Controls {
    arrows: [Button; 4],
    select: Button,
    alone: OneButton,
    letters: [Button; 4],
}

impl Controls {
    /// Takes the reading of one tick of the clock. Returns the commands of up, down, left, right
    /// and select.
    pub fn tick(
        &mut self,
        Pressed {
            up,
            down,
            left,
            right,
            select,
            letters,
        }: Pressed,
    ) -> impl Iterator<Item = Command> + use<> {
        let select = self.select.tick(select);
        let with_select = self.select.is_held();

        let mut commands = [None; 4];
        let arrows = ARROWS
            .into_iter()
            .zip(&mut self.arrows)
            .zip([up, down, left, right]);

        // An arrow repeats when it is used alone.
        for (command, (([alone, held], button), pressed)) in commands.iter_mut().zip(arrows) {
            *command = match button.tick(pressed) {
                Some(Change::Pressed) if with_select => Some(held),
                Some(Change::Pressed | Change::Repeated) if !with_select => Some(alone),
                _ => None,
            };
        }

        // The select button has its own commands unless an arrow was used.
        let alone = self
            .alone
            .tick(select, commands.iter().any(Option::is_some));

        let mut lettered = [None; 4];
        let letters = LETTERS.into_iter().zip(&mut self.letters).zip(letters);
        for (command, ((letter, button), pressed)) in lettered.iter_mut().zip(letters) {
            let is_pressed = button.tick(pressed) == Some(Change::Pressed);
            *command = is_pressed.then_some(letter);
        }
        let commands = commands.into_iter().flatten().chain(alone);
        commands.chain(lettered.into_iter().flatten())
    }
}

/// The commands of select when it is held after no tap, one, two, three or four taps. All except
/// the first repeat.
const HELD: [Command; 5] = [
    Command::NextScene,
    Command::Heavier,
    Command::Lighter,
    Command::TurnRight,
    Command::TurnLeft,
];

#[derive(Clone, Debug, Default)]
struct OneButton {
    /// `None` if it is released, or is held together with another button.
    held: Option<u8>,
    /// True if holding it has already caused a command: its release is then not a tap.
    served: bool,
    taps: usize,
    since: u8,
}

impl OneButton {
    /// `with_another` is true if an arrow has caused a command in this tick.
    fn tick(&mut self, change: Option<Change>, with_another: bool) -> Option<Command> {
        self.since = self.since.saturating_add(1);

        match change {
            Some(Change::Pressed) => {
                if self.since > MOST_TICKS_BETWEEN_TAPS {
                    self.taps = 0;
                }
                self.held = Some(0);
                self.served = false;
            }
            Some(Change::Released) => {
                let tapped = self.held.take().is_some() && !self.served;
                self.taps = if tapped {
                    self.taps.saturating_add(1)
                } else {
                    0
                };
                self.since = 0;
                return tapped.then_some(Command::Restart);
            }
            Some(Change::Repeated) | None => {}
        }

        // Another button was pressed as well: this is no longer a hold of select alone.
        if with_another {
            self.held = None;
        }

        let held = self.held.as_mut()?;

        *held = held.saturating_add(1);
        if *held < HOLD_TICKS {
            return None;
        }

        // Held long enough. The next scene does not repeat.
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
    /// The button is held long enough to count as pressed again.
    Repeated,
    Released,
}

#[derive(Clone, Debug, Default)]
struct Button {
    phase: Phase,
    contradictions: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// The button has not been seen released yet. A line that reads pressed from the beginning may
    /// be stuck or not driven, so it is ignored.
    #[default]
    Unproven,
    Released,
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

        // The level has not changed, but a held button repeats.
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
