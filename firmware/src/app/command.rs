//! What can be asked of the player, by button or over the serial link.

use crate::protocol::choice::choice;
use crate::protocol::{
    Ask, AskPlan, Choose, Field, Identify, Measure, Message, Pause, Press, Refused, Restart, Set, Step, request,
};
use crate::scenes::SceneName;

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Command {
    /// The next larger mass ratio.
    Heavier,
    /// The next smaller mass ratio.
    Lighter,
    /// The start angle one step clockwise.
    TurnLeft,
    /// The start angle one step counter-clockwise.
    TurnRight,
    Restart,
    NextScene,
    PreviousScene,
    Choose(SceneName),
    Set {
        field: Field,
        /// Its value, in SI units.
        value: f64,
    },
    /// Stop the scene's time, or let it go on.
    Pause(bool),
    TogglePause,
    /// So many ticks, then stop.
    Step(u32),
    /// Nothing but an answer: what is played.
    Ask,
    /// Nothing but an answer: what the plan of it is.
    AskPlan,
    /// Nothing but an answer: what the board is.
    Identify,
    /// Nothing but an answer: how long steps of the motion asked for last take.
    Measure {
        steps: u32,
        /// By their code in memory, otherwise by that in flash.
        in_ram: bool,
    },
}

choice! {
    Key {
        Up = 0, "up";
        Down = 1, "down";
        Left = 2, "left";
        Right = 3, "right";
        Select = 4, "select";
    }
}

impl Key {
    /// What a tap on it alone asks for.
    pub const fn tapped(self) -> Command {
        match self {
            Self::Up => Command::Heavier,
            Self::Down => Command::Lighter,
            Self::Left => Command::TurnLeft,
            Self::Right => Command::TurnRight,
            Self::Select => Command::Restart,
        }
    }

    /// What an arrow asks for while select is held.
    pub(super) const fn with_select(self) -> Command {
        match self {
            Self::Up => Command::TogglePause,
            Self::Down => Command::Step(1),
            Self::Left => Command::PreviousScene,
            Self::Right => Command::NextScene,
            Self::Select => Command::Restart,
        }
    }
}

/// A command that came as a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostCommand {
    /// The number to answer it with.
    pub request: u16,
    pub command: Command,
}

impl HostCommand {
    /// The command in an intact message, or why there is none.
    pub fn read(kind: u8, fields: &[u8]) -> Result<Self, Refused> {
        // Even one of unknown kind is answered.
        let (request, command) = known(kind, fields).unwrap_or((request(fields), Err(Field::Message)));
        command.map(|command| Self { request, command }).map_err(|field| Refused { request, field: field.code() })
    }
}

/// `None` if there is no such kind or the fields are not that kind's.
fn known(kind: u8, fields: &[u8]) -> Option<(u16, Result<Command, Field>)> {
    Some(match kind {
        Set::KIND => {
            let Set { request, field, value } = Message::read(fields)?;
            let field = Field::from_code(field).ok_or(Field::Field);
            (request, field.map(|field| Command::Set { field, value }))
        }
        Choose::KIND => {
            let Choose { request, scene } = Message::read(fields)?;
            (request, SceneName::from_code(scene).map(Command::Choose).ok_or(Field::Scene))
        }
        Pause::KIND => {
            let Pause { request, paused } = Message::read(fields)?;
            (request, Ok(Command::Pause(paused != 0)))
        }
        Step::KIND => {
            let Step { request, ticks } = Message::read(fields)?;
            (request, Ok(Command::Step(ticks)))
        }
        Press::KIND => {
            let Press { request, key } = Message::read(fields)?;
            (request, Key::from_code(key).map(Key::tapped).ok_or(Field::Key))
        }
        Measure::KIND => {
            let Measure { request, steps, in_ram } = Message::read(fields)?;
            (request, Ok(Command::Measure { steps, in_ram: in_ram != 0 }))
        }
        Restart::KIND => (Restart::read(fields)?.request, Ok(Command::Restart)),
        Ask::KIND => (Ask::read(fields)?.request, Ok(Command::Ask)),
        AskPlan::KIND => (AskPlan::read(fields)?.request, Ok(Command::AskPlan)),
        Identify::KIND => (Identify::read(fields)?.request, Ok(Command::Identify)),
        _ => return None,
    })
}
