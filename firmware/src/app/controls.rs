//! Five buttons become commands.

use crate::app::button::{Button, Change};
use crate::app::one_button::OneButton;
use crate::app::{Command, Key};

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

const ARROWS: [Key; 4] = [Key::Up, Key::Down, Key::Left, Key::Right];

/// The five buttons' history.
///
/// | button | alone, repeating | with select held |
/// |---|---|---|
/// | up | next larger mass ratio | stop the scene's time, or let it go on |
/// | down | next smaller mass ratio | one tick, then stop |
/// | left | start angle clockwise | scene before |
/// | right | start angle counter-clockwise | next scene |
///
/// Select alone does for all: let go it asks for a restart, held for [`HOLD_TICKS`](crate::config::HOLD_TICKS) for the next
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
        Pressed { up, down, left, right, select }: Pressed,
    ) -> impl Iterator<Item = Command> + use<> {
        let select = self.select.tick(select);
        let with_select = self.select.is_held();
        let mut asked = [None; 4];
        let arrows = ARROWS.into_iter().zip(&mut self.arrows).zip([up, down, left, right]);
        for (asked, ((key, button), pressed)) in asked.iter_mut().zip(arrows) {
            *asked = match button.tick(pressed) {
                Some(Change::Pressed) if with_select => Some(key.with_select()),
                Some(Change::Pressed | Change::Repeated) if !with_select => Some(key.tapped()),
                _ => None,
            };
        }
        let alone = self.alone.tick(select, asked.iter().any(Option::is_some));
        asked.into_iter().flatten().chain(alone)
    }
}
