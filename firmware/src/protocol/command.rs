//! What the host asks for, and what can be wrong in it.

use double_pendulum::{Error, Method, Parameter};
use serde::{Deserialize, Serialize};

use super::{MAX_WIRE, encode, read};
use crate::display::Controller;
use crate::job::Request;
use crate::motion::Settings;
use crate::scenes::SceneName;

/// What is asked of the application, by button or over the serial link.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Command {
    Heavier,
    Lighter,
    /// The start angle one step clockwise.
    TurnLeft,
    /// The start angle one step counter-clockwise.
    TurnRight,
    /// Start again with the same settings.
    Restart,
    NextScene,
    PreviousScene,
    /// Play a scene with the settings that are its own.
    Choose(SceneName),
    /// Set one parameter and start again with it. Speed does not start again.
    Set {
        field: Field,
        /// Its value, in SI units.
        value: f64,
    },
    /// Start again by this method and no other, or as the plan has it.
    Method(Option<Method>),
    /// Stop the scene's time, or let it go on.
    Pause(bool),
    TogglePause,
    /// So many ticks, one in each tick of the clock, then stop.
    Step(u32),
    /// Nothing but an answer: what is played.
    Ask,
    /// Nothing but an answer: what the plan of it is, as far as it is found.
    AskPlan,
    /// Nothing but an answer: what the board is.
    Identify,
    /// Nothing but answers: the samples of this motion, computed in the time that frames leave free. It replaces one under way.
    Simulate(Request),
    /// Nothing but an answer: how long it takes to go on with the motion asked for last, so many steps at once and with interrupts
    /// off. At most [`MOST_MEASURED_STEPS`](crate::config::MOST_MEASURED_STEPS) are made.
    Measure {
        steps: u32,
        /// By their code in memory, otherwise by that in flash.
        in_ram: bool,
    },
    /// Drive the panel as this controller; `None` identifies it. The choice outlasts a restart.
    Panel(Option<Controller>),
    /// Play a scene with these settings, all at once: a few of them alone may be impossible.
    Play(SceneName, Settings),
    /// Asks for the last restart that the board made by itself; changes nothing.
    AskRestart,
}

/// Stands before every command, and before no message to the host: there a smaller number says which it is.
const TO_CHIP: u8 = 0x80;

/// The command as it goes over the wire; every answer repeats the number.
pub fn encode_command(request: u16, command: Command, wire: &mut [u8; MAX_WIRE]) -> &[u8] {
    encode(&(TO_CHIP, request, command), wire)
}

/// The number of an intact command, and the command if it can be read; `None` of a message that is none.
pub fn decode_command(message: &[u8]) -> Option<(u16, Option<Command>)> {
    let numbered = message.strip_prefix(&[TO_CHIP])?;
    Some(
        postcard::take_from_bytes(numbered)
            .map_or((0, None), |(request, command)| (request, read(command))),
    )
}

choice! {
    /// What a command sets, or what is wrong in one.
    Field {
        Method = "method";
        M1 = "m1";
        M2 = "m2";
        L1 = "l1";
        L2 = "l2";
        G = "g";
        A1 = "a1";
        A2 = "a2";
        W1 = "w1";
        W2 = "w2";
        Dt = "step size";
        /// Mass ratio m2/m1: sets m2.
        MassRatio = "mu";
        /// Of both rods.
        Angle = "angle";
        /// Simulated time per real time.
        Speed = "speed";
        /// What cannot be set.
        Field = "field";
        /// The message itself: no known command, or not with that command's fields.
        Message = "message";
        /// The board has no panel with a choice of controllers.
        Panel = "panel";
    }
}

impl From<Error> for Field {
    fn from(error: Error) -> Self {
        if let Error::Diverged { .. } = error {
            return Field::Dt;
        }
        match error.parameter() {
            Parameter::M1 => Field::M1,
            Parameter::M2 => Field::M2,
            Parameter::L1 => Field::L1,
            Parameter::L2 => Field::L2,
            Parameter::G => Field::G,
            Parameter::A1 => Field::A1,
            Parameter::A2 => Field::A2,
            // A momentum at the start is the velocity times masses and lengths.
            Parameter::W1 | Parameter::P1 => Field::W1,
            Parameter::W2 | Parameter::P2 => Field::W2,
            _ => Field::Dt,
        }
    }
}
