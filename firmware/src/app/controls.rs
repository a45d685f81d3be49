//! The controls: five debounced buttons, or a single one, become commands.

use crate::config::{
    DEBOUNCE_TICKS, HOLD_TICKS, MOST_TICKS_BETWEEN_TAPS, REPEAT_DELAY_TICKS, REPEAT_PERIOD_TICKS,
};
use crate::protocol::Command;

choice! {
    /// The name of a button. [`Pressed`] is a reading of all five.
    Key {
        Up = "up";
        Down = "down";
        Left = "left";
        Right = "right";
        Select = "select";
    }
}

/// A reading of the five buttons, not debounced; `true` means pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pressed {
    pub up: bool,
    pub down: bool,
    pub left: bool,
    pub right: bool,
    pub select: bool,
}

/// The buttons of a board.
pub trait Buttons {
    /// Returns the levels of the buttons now, without waiting. The application reads them once a
    /// tick and debounces them itself.
    fn read(&mut self) -> Pressed;
}

/// The buttons of a board without any: none is ever pressed.
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

/// The state of the five buttons, from readings of one tick to commands.
///
/// A level counts when [`DEBOUNCE_TICKS`] readings in a row show it. A button has no effect until
/// it has been released once.
///
/// | button | alone, repeating | with select held |
/// |---|---|---|
/// | up | next larger mass ratio | pause the scene, or let it continue |
/// | down | next smaller mass ratio | advance one tick, then pause |
/// | left | start angle clockwise | previous scene |
/// | right | start angle counter-clockwise | next scene |
///
/// An arrow that is held alone repeats after [`REPEAT_DELAY_TICKS`], and then every
/// [`REPEAT_PERIOD_TICKS`]. With select held it acts once for each press. After that select itself
/// has no effect until it is released, and earlier taps do not count. An arrow that was pressed
/// before select has no effect while select is held.
///
/// The select button alone can do the most important things. A tap restarts the scene when it ends:
/// a press shorter than [`HOLD_TICKS`], in which no arrow has caused a command. Holding it for
/// [`HOLD_TICKS`] selects the next scene, once. Holding it that long after one, two, three or four
/// taps is instead a heavier bob 2, a lighter one, a turn to the right or to the left, and repeats
/// every [`REPEAT_PERIOD_TICKS`]. After more taps it does nothing. Each of these taps has restarted
/// the scene. Taps belong together if at most [`MOST_TICKS_BETWEEN_TAPS`] are between them.
#[derive(Clone, Debug, Default)]
pub struct Controls {
    arrows: [Button; 4],
    select: Button,
    alone: OneButton,
}

impl Controls {
    /// Takes the reading of one tick of the clock; call it once in every tick. Returns the commands
    /// of the buttons, usually none: at most one for each of up, down, left and right, in this
    /// order, and then the select button's own command.
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
        commands.into_iter().flatten().chain(alone)
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

/// The state of the select button when it is used alone.
#[derive(Clone, Debug, Default)]
struct OneButton {
    /// The time that it has been held alone, ticks; `None` if it is released, or is held together
    /// with another button.
    held: Option<u8>,
    /// True if holding it has already caused a command: its release is then not a tap.
    served: bool,
    /// The number of taps in a row.
    taps: usize,
    /// The number of ticks since the last tap.
    since: u8,
}

impl OneButton {
    /// Takes the change of the button in this tick, and true if an arrow has caused a command in
    /// it. Returns the command of the select button. A tap restarts the scene when it ends.
    fn tick(&mut self, change: Option<Change>, with_another: bool) -> Option<Command> {
        self.since = self.since.saturating_add(1);

        // A press begins a hold. A short press is a tap.
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

        // Count the time of the hold.
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

/// A change of a debounced button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Change {
    Pressed,
    /// The button is held long enough to count as pressed again.
    Repeated,
    Released,
}

/// A button that repeats while it is held.
#[derive(Clone, Debug, Default)]
struct Button {
    phase: Phase,
    /// The number of readings in a row that contradict the phase.
    contradictions: u8,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// The button has not been seen released yet. A line that reads pressed from the beginning may
    /// be stuck or not driven, so it is ignored.
    #[default]
    Unproven,
    Released,
    /// The button is held. It counts as pressed again after this number of ticks.
    Held {
        repeats_in: u8,
    },
}

impl Button {
    fn is_held(&self) -> bool {
        matches!(self.phase, Phase::Held { .. })
    }

    /// Takes the reading of one tick. Returns the change of the debounced button; `None` if its
    /// level stays and no repetition is due, or if it is released for the first time.
    fn tick(&mut self, pressed: bool) -> Option<Change> {
        let contradicts = if self.phase == Phase::Unproven {
            !pressed
        } else {
            pressed != self.is_held()
        };

        // Count the readings in a row that contradict the phase.
        self.contradictions = if contradicts {
            self.contradictions.saturating_add(1)
        } else {
            0
        };

        // The level has changed for long enough.
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
