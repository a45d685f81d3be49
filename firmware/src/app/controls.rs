//! Five buttons become commands: debounced, and repeated while held.

use crate::app::command::Command;
use crate::app::one_button::OneButton;
use crate::config::{DEBOUNCE_TICKS, REPEAT_DELAY_TICKS, REPEAT_PERIOD_TICKS};
use crate::protocol::choice::choice;

choice! {
    /// A button.
    Key {
        /// Up.
        Up = 0, "up";
        /// Down.
        Down = 1, "down";
        /// Left.
        Left = 2, "left";
        /// Right.
        Right = 3, "right";
        /// Select.
        Select = 4, "select";
    }
}

impl Key {
    /// What a tap on it alone asks for.
    pub const fn tapped(self) -> Command {
        match self {
            Self::Up => UP[0],
            Self::Down => DOWN[0],
            Self::Left => LEFT[0],
            Self::Right => RIGHT[0],
            Self::Select => Command::Restart,
        }
    }
}

/// A reading of the five buttons; `true` is pressed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pressed {
    /// Up.
    pub up: bool,
    /// Down.
    pub down: bool,
    /// Left.
    pub left: bool,
    /// Right.
    pub right: bool,
    /// Select.
    pub select: bool,
}

/// Where readings come from.
pub trait Buttons {
    /// How the buttons are now.
    fn read(&mut self) -> Pressed;
}

/// For a board without buttons.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoButtons;

impl Buttons for NoButtons {
    fn read(&mut self) -> Pressed {
        Pressed::default()
    }
}

/// What an arrow asks for, and what while select is held.
const UP: [Command; 2] = [Command::Heavier, Command::TogglePause];
const DOWN: [Command; 2] = [Command::Lighter, Command::Step(1)];
const LEFT: [Command; 2] = [Command::TurnLeft, Command::PreviousScene];
const RIGHT: [Command; 2] = [Command::TurnRight, Command::NextScene];

/// The five buttons' history.
///
/// | button | alone, repeating | with select held |
/// |---|---|---|
/// | up | next larger mass ratio | stop the scene's time, or let it go on |
/// | down | next smaller mass ratio | one tick, then stop |
/// | left | start angle clockwise | scene before |
/// | right | start angle counter-clockwise | next scene |
///
/// Select alone does for all: let go it asks for a restart, held for [`HOLD_TICKS`](crate::config::HOLD_TICKS) for the next scene, and held after taps
/// for another mass ratio or start angle.
#[derive(Clone, Debug, Default)]
pub struct Controls {
    up: Button,
    down: Button,
    left: Button,
    right: Button,
    select: Button,
    alone: OneButton,
}

impl Controls {
    /// Takes the reading of one tick and returns what it asks for.
    pub fn tick(&mut self, pressed: Pressed) -> impl Iterator<Item = Command> + use<> {
        let select = self.select.tick(pressed.select);
        let shifted = self.select.is_held();
        let arrows = [
            (self.up.tick(pressed.up), &UP),
            (self.down.tick(pressed.down), &DOWN),
            (self.left.tick(pressed.left), &LEFT),
            (self.right.tick(pressed.right), &RIGHT),
        ]
        .map(|(change, [plain, with_select])| match change? {
            Change::Pressed if shifted => Some(with_select),
            Change::Pressed | Change::Repeated if !shifted => Some(plain),
            _ => None,
        });
        let alone = self.alone.tick(select, arrows.iter().any(Option::is_some));
        arrows.into_iter().flatten().copied().chain(alone)
    }
}

/// What a button does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// It is pressed.
    Pressed,
    /// Held long enough to count as pressed again.
    Repeated,
    /// It is let go.
    Released,
}

/// One button's history.
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

    /// Takes one reading.
    fn tick(&mut self, pressed: bool) -> Option<Change> {
        let contradicts = if self.phase == Phase::Unproven { !pressed } else { pressed != self.is_held() };
        self.contradictions = if contradicts { self.contradictions.saturating_add(1) } else { 0 };
        if self.contradictions >= DEBOUNCE_TICKS {
            self.contradictions = 0;
            let proven = self.phase != Phase::Unproven;
            self.phase = if pressed { Phase::Held { repeats_in: REPEAT_DELAY_TICKS } } else { Phase::Released };
            return proven.then_some(if pressed { Change::Pressed } else { Change::Released });
        }
        let Phase::Held { repeats_in } = &mut self.phase else { return None };
        *repeats_in = repeats_in.saturating_sub(1);
        (*repeats_in == 0).then(|| {
            *repeats_in = REPEAT_PERIOD_TICKS;
            Change::Repeated
        })
    }
}
