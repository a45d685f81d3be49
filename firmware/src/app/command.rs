//! What can be asked of the player, by button or over the serial link.

use crate::protocol::choice;
use crate::protocol::{
    Ask, AskPlan, Choose, Field, Identify, Measure, Message, Pause, Press, Request, Restart, Set, Simulate, Step,
};
use crate::scenes::SceneName;

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Command {
    Heavier,
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
    /// Nothing but answers: the samples of this motion, computed in the time that frames leave free.
    Simulate(Request),
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

impl Command {
    /// The command in an intact message, or what is wrong with it: of one of an unknown kind, the message itself.
    pub(super) fn read(kind: u8, fields: &[u8]) -> Result<Self, Field> {
        fn all<M: Message>(fields: &[u8]) -> Result<M, Field> {
            M::read(fields).ok_or(Field::Message)
        }
        Ok(match kind {
            Simulate::KIND => Self::Simulate(all::<Simulate>(fields)?.motion),
            Set::KIND => {
                let Set { field, value, .. } = all(fields)?;
                Self::Set { field: Field::from_code(field).ok_or(Field::Field)?, value }
            }
            Choose::KIND => Self::Choose(SceneName::from_code(all::<Choose>(fields)?.scene).ok_or(Field::Scene)?),
            Pause::KIND => Self::Pause(all::<Pause>(fields)?.paused != 0),
            Step::KIND => Self::Step(all::<Step>(fields)?.ticks),
            Press::KIND => Key::from_code(all::<Press>(fields)?.key).ok_or(Field::Key)?.tapped(),
            Measure::KIND => {
                let Measure { steps, in_ram, .. } = all(fields)?;
                Self::Measure { steps, in_ram: in_ram != 0 }
            }
            Restart::KIND => all::<Restart>(fields).map(|_| Self::Restart)?,
            Ask::KIND => all::<Ask>(fields).map(|_| Self::Ask)?,
            AskPlan::KIND => all::<AskPlan>(fields).map(|_| Self::AskPlan)?,
            Identify::KIND => all::<Identify>(fields).map(|_| Self::Identify)?,
            _ => return Err(Field::Message),
        })
    }
}
