//! What can be asked of the player, by button or over the serial link.

use crate::app::controls::Key;
use crate::protocol::Field;
use crate::protocol::Unit;
use crate::protocol::{self, Message, Refused};
use crate::scenes::SceneName;

/// What the user asks for.
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
    /// From the start again.
    Restart,
    /// The next scene of the catalogue.
    NextScene,
    /// The one before.
    PreviousScene,
    /// This scene.
    Choose(SceneName),
    /// One parameter.
    Set {
        /// Which.
        field: Field,
        /// Its value in the unit that the field is kept in.
        value: f64,
    },
    /// Stop the scene's time, or let it go on.
    Pause(bool),
    /// Whichever of the two it is not doing.
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
        /// How many.
        steps: u32,
        /// By their code in memory, otherwise by that in flash.
        in_ram: bool,
    },
}

/// A command that came as a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostCommand {
    /// The number to answer it with.
    pub request: u16,
    /// What is asked.
    pub command: Command,
}

impl HostCommand {
    /// The order in an intact message, or why it is none.
    pub fn read(kind: u8, fields: &[u8]) -> Result<Self, Refused> {
        Self::known(kind, fields).unwrap_or_else(|| {
            // Every message to the chip begins with its number, so that even one of unknown kind can be answered.
            let request = fields.first_chunk().map_or(0, |bytes| u16::from_le_bytes(*bytes));
            Err(Refused { request, field: Field::Message.code() })
        })
    }

    /// `None` if there is no such kind or the length is not that kind's.
    fn known(kind: u8, fields: &[u8]) -> Option<Result<Self, Refused>> {
        let (request, command) = match kind {
            protocol::Set::KIND => {
                let message = protocol::Set::read(fields)?;
                (message.request, set(&message))
            }
            protocol::Choose::KIND => {
                let protocol::Choose { request, scene } = Message::read(fields)?;
                (request, SceneName::from_code(scene).map(Command::Choose).ok_or(Field::Scene))
            }
            protocol::Restart::KIND => (protocol::Restart::read(fields)?.request, Ok(Command::Restart)),
            protocol::Pause::KIND => {
                let protocol::Pause { request, paused } = Message::read(fields)?;
                (request, Ok(Command::Pause(paused != 0)))
            }
            protocol::Step::KIND => {
                let protocol::Step { request, ticks } = Message::read(fields)?;
                (request, Ok(Command::Step(ticks)))
            }
            protocol::Press::KIND => {
                let protocol::Press { request, key } = Message::read(fields)?;
                (request, Key::from_code(key).map(Key::tapped).ok_or(Field::Key))
            }
            protocol::Ask::KIND => (protocol::Ask::read(fields)?.request, Ok(Command::Ask)),
            protocol::AskPlan::KIND => (protocol::AskPlan::read(fields)?.request, Ok(Command::AskPlan)),
            protocol::Identify::KIND => (protocol::Identify::read(fields)?.request, Ok(Command::Identify)),
            protocol::Measure::KIND => {
                let protocol::Measure { request, steps, in_ram } = Message::read(fields)?;
                (request, Ok(Command::Measure { steps, in_ram: in_ram != 0 }))
            }
            _ => return None,
        };
        let order = command.map(|command| Self { request, command });
        Some(order.map_err(|field| Refused { request, field: field.code() }))
    }
}

/// The field to set must be a quantity, and the unit one of its own.
fn set(message: &protocol::Set) -> Result<Command, Field> {
    let field = Field::from_code(message.field).ok_or(Field::Field)?;
    let kept_in = Unit::of(field).ok_or(Field::Field)?;
    let unit = Unit::from_code(message.unit).ok_or(Field::Unit)?;
    let value = unit.convert(message.value, kept_in).ok_or(Field::Unit)?;
    Ok(Command::Set { field, value })
}
