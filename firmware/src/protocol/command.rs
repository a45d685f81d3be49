//! The commands of a host, and the fields that can be wrong in them.

use double_pendulum::{Error, Method, Parameter};
use serde::{Deserialize, Serialize};

use super::{MAX_WIRE, encode, read};
use crate::display::Controller;
use crate::job::Request;
use crate::motion::Settings;
use crate::scenes::SceneName;

/// A command to the application, from a button or over the serial link.
///
/// An impossible command changes nothing. Over the link its answer is
/// [`Answer::Refused`](super::Answer::Refused) with the field that is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Command {
    /// Selects the next larger mass ratio of [`MASS_RATIOS`](crate::config::MASS_RATIOS), and
    /// starts the scene again. The largest one stays.
    Heavier,
    /// Selects the next smaller mass ratio, and starts the scene again. The smallest one stays.
    Lighter,
    /// Turns both start angles by one [`ANGLE_STEP`](crate::config::ANGLE_STEP) clockwise, to -180
    /// degrees at most, and starts the scene again. A scene without start angles ignores it.
    TurnLeft,
    /// Turns both start angles by one step counter-clockwise, to 180 degrees at most.
    TurnRight,
    /// Starts the scene again with the same settings.
    Restart,
    /// Plays the next scene of the catalogue with its own initial settings; after the last the
    /// first.
    NextScene,
    /// Plays the previous scene of the catalogue with its own initial settings; before the first
    /// the last.
    PreviousScene,
    /// Plays a scene with its own initial settings.
    Choose(SceneName),
    /// Sets one parameter and starts the scene again with it. A change of the speed does not
    /// restart the scene.
    ///
    /// It accepts `M1` to `W2`, `MassRatio`, `Angle` and `Speed`. Another field is refused with
    /// [`Field::Field`]. A value with which the scene cannot start, and an angle beyond straight up
    /// (pi rad), are refused with their own field.
    Set {
        field: Field,
        /// The value, in SI units; of an angle in rad.
        value: f64,
    },
    /// Starts the scene again by this method and no other; `None` leaves the choice to the plan.
    /// Later starts use the method where they can, and otherwise follow their plan. Refused with
    /// [`Field::Method`] if the method is not in [`Method::DRAWN`], or if the present scene cannot
    /// start by it. Figures, `small-*` and `upright` ignore it.
    Method(Option<Method>),
    /// Pauses the scene (`true`) or lets it continue. It ends a [`Step`](Self::Step).
    Pause(bool),
    /// Pauses the scene, or lets it continue if it is paused.
    TogglePause,
    /// Advances the scene by this number of ticks, one in each tick of the clock, and then pauses
    /// it; 0 pauses it at once.
    Step(u32),
    /// Requests the scene, its settings and its state. Changes nothing.
    Ask,
    /// Requests the plan of the scene, as far as it is known. Changes nothing.
    AskPlan,
    /// Requests the identity of the board. Changes nothing.
    Identify,
    /// Requests the samples of this motion. They are computed in the time that frames leave free.
    /// The scene continues. A job in progress is replaced, unless this request is refused, such as
    /// with [`Field::Method`] if the application lacks the method.
    Simulate(Request),
    /// Requests the time of this number of further steps of the last requested motion. They are
    /// made without a break and with interrupts off, at most
    /// [`MOST_MEASURED_STEPS`](crate::config::MOST_MEASURED_STEPS). No sample of that motion
    /// follows. Refused with [`Field::Message`] if no motion was requested.
    Measure {
        steps: u32,
        /// True to run the code of the steps in RAM, false to run it in flash.
        in_ram: bool,
    },
    /// Drives the panel as this controller; `None` identifies it. The choice is kept across a
    /// restart. Refused with [`Field::Panel`] if the panel has no choice of controllers.
    Panel(Option<Controller>),
    /// Plays a scene with these settings. They are set all at once, because a part of them alone
    /// may be impossible. Angles beyond 180 degrees either way are refused.
    Play(SceneName, Settings),
    /// Requests the last restart that the board made on its own. Changes nothing.
    AskRestart,
}

/// The mark byte before every command. A message to the host begins with a smaller number, which is
/// its kind.
const TO_CHIP: u8 = 0x80;

/// Encodes a command for the wire, with its delimiters. Returns the used part of `wire`; every
/// command fits. `request` is a number that every answer to it repeats.
pub fn encode_command(request: u16, command: Command, wire: &mut [u8; MAX_WIRE]) -> &[u8] {
    encode(&(TO_CHIP, request, command), wire)
}

/// Returns the number of an intact command, and the command if it can be read. `message` is without
/// version and CRC, as [`Decoder::push`](super::Decoder::push) returns it.
///
/// Returns `None` if the message is not a command, that is if it does not begin with the mark byte
/// 0x80. If not even the number can be read, it is 0.
pub fn decode_command(message: &[u8]) -> Option<(u16, Option<Command>)> {
    let numbered = message.strip_prefix(&[TO_CHIP])?;
    Some(
        postcard::take_from_bytes(numbered)
            .map_or((0, None), |(request, command)| (request, read(command))),
    )
}

choice! {
    /// A field that a command sets, or that is wrong in a command.
    Field {
        /// The requested method.
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
        /// The mass ratio m2/m1; m2 is set.
        MassRatio = "mu";
        /// The start angle of both rods, rad.
        Angle = "angle";
        /// The simulated time per real time, 0.01 to 4.
        Speed = "speed";
        /// A field that cannot be set.
        Field = "field";
        /// The message itself: it is no known command, or does not have the fields of that command.
        Message = "message";
        /// The board has no panel with a choice of controllers.
        Panel = "panel";
    }
}

impl From<Error> for Field {
    /// Returns the field that an error of the kernel is about. An error without such a field, and a
    /// motion that diverged, count as a wrong step size.
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
            // The initial momenta follow from the velocities, masses and lengths.
            Parameter::W1 | Parameter::P1 => Field::W1,
            Parameter::W2 | Parameter::P2 => Field::W2,
            _ => Field::Dt,
        }
    }
}
