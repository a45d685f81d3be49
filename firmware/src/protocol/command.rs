//! The commands of a host, and the fields that can be wrong in them.

use double_pendulum::{Error, Method, Parameter};
use serde::{Deserialize, Serialize};

use super::{MAX_WIRE, encode, read};
use crate::config::GREATEST_ANGLE;
use crate::display::Controller;
use crate::job::Request;
use crate::motion::Settings;
use crate::scenes::SceneName;

/// A command to the application, from a button or over the serial link.
///
/// An impossible command changes nothing. Over the link its answer is
/// [`Answer::Refused`](super::Answer::Refused) with the wrong field.
///
/// A scene that starts keeps the pause, the ticks left of a [`Step`](Self::Step), the speed and the
/// requested method. If it cannot start by that method, it follows its plan. A motion that is too
/// fast starts, and is [`Stopped`](super::PlayState::Stopped).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Command {
    /// Selects the next larger mass ratio m2/m1 of [`MASS_RATIOS`](crate::config::MASS_RATIOS), by
    /// another m2, and starts the scene again. At the end of the list the ratio stays.
    Heavier,
    /// Selects the next smaller mass ratio in the same way.
    Lighter,
    /// Turns both start angles clockwise by [`ANGLE_STEP`](crate::config::ANGLE_STEP), each to
    /// straight up at most, and starts the scene again. A scene without start angles continues.
    TurnLeft,
    /// Turns both start angles counter-clockwise in the same way.
    TurnRight,
    /// Starts the scene again with the same settings.
    Restart,
    /// Plays the next scene of the catalogue with its own initial settings, in a circle.
    NextScene,
    /// Plays the previous scene of the catalogue in the same way.
    PreviousScene,
    /// Plays a scene with its own initial settings.
    Choose(SceneName),
    /// Sets one parameter and starts the scene again with it; the speed changes without a restart.
    ///
    /// It accepts `M1` to `W2`, `MassRatio` (by another m2), `Angle` (both start angles) and
    /// `Speed`, and refuses other fields with [`Field::Field`]. A value with which the scene cannot
    /// start is refused with its own field.
    Set { field: Field, value: f64 },
    /// Starts the scene again by this method and no other; `None` leaves the choice to the plan.
    /// Later starts use the method where they can, and otherwise follow their plan.
    ///
    /// Refused with [`Field::Method`] if the present scene cannot start by it.
    Method(Option<Method>),
    /// Pauses the scene (`true`) or lets it continue. It ends a [`Step`](Self::Step).
    Pause(bool),
    /// Pauses the scene, or lets it continue if it is paused.
    TogglePause,
    /// Advances the scene by this number of ticks, one in each tick of the clock at any speed, and
    /// then leaves it paused.
    Step(u32),
    /// Requests the scene, its settings and its state ([`Answer::Status`](super::Answer::Status)).
    Ask,
    /// Requests the plan of the scene, as far as it is known
    /// ([`Answer::Planned`](super::Answer::Planned)).
    AskPlan,
    /// Requests the identity of the board ([`Answer::Identity`](super::Answer::Identity)).
    Identify,
    /// Requests the samples of this motion ([`Answer::Sample`](super::Answer::Sample)), computed in
    /// the time that frames leave free. It replaces a job in progress.
    Simulate(Request),
    /// Requests the time of this number of further steps of the last requested motion
    /// ([`Answer::Measured`](super::Answer::Measured)). They are made without a break and with
    /// interrupts off. A number above
    /// [`MOST_MEASURED_STEPS`](crate::config::MOST_MEASURED_STEPS), 16, counts as 16. No sample of
    /// that motion follows, also after 0 steps, but it can be measured again. A motion that has
    /// ended or diverged can be measured, too. Refused with [`Field::Message`] if no
    /// [`Simulate`](Self::Simulate) has been executed since reset.
    Measure(u32),
    /// Drives the panel as this controller from the next frame on; `None` identifies it. The choice
    /// is kept across every reset that leaves memory powered. Refused with [`Field::Panel`] if the
    /// panel has no such options.
    Panel(Option<Controller>),
    /// Plays a scene with these settings, whose angles are in degrees. They are set all at once,
    /// because a part of them alone may be impossible.
    Play(SceneName, Settings),
    /// Requests the last restart that the board made on its own
    /// ([`Answer::Restart`](super::Answer::Restart)).
    AskRestart,
    /// Turns the picture by 180 degrees, or back. Kept and refused as [`Panel`](Self::Panel).
    Turn(bool),
    /// Dims the panel after [`DIM_TICKS`](crate::config::DIM_TICKS) without a key, or keeps it
    /// bright. Kept and refused as [`Panel`](Self::Panel).
    Dim(bool),
}

/// The mark byte before every command. A message to the host begins with a smaller number, which is
/// its kind.
const TO_CHIP: u8 = 0x80;

/// Encodes a command for the wire, as [`encode`](super::encode) does. Every answer to it repeats
/// the number `request`.
pub fn encode_command(request: u16, command: Command, wire: &mut [u8; MAX_WIRE]) -> &[u8] {
    encode(&(TO_CHIP, request, command), wire)
}

/// Returns the number of an intact command, and the command. Returns `None` if the message is no
/// command; the command is `None` if it is unknown or incomplete.
pub fn decode_command(message: &[u8]) -> Option<(u16, Option<Command>)> {
    let numbered = message.strip_prefix(&[TO_CHIP])?;
    Some(
        postcard::take_from_bytes(numbered)
            .map_or((0, None), |(request, command)| (request, read(command))),
    )
}

choice! {
    /// A field that a command sets, or that is wrong in a command. Angles are from the downward
    /// vertical, positive counter-clockwise.
    Field {
        Method = "method";
        /// The mass of bob 1, kg.
        M1 = "m1";
        /// The mass of bob 2, kg.
        M2 = "m2";
        /// The length of rod 1, m.
        L1 = "l1";
        /// The length of rod 2, m.
        L2 = "l2";
        G = "g";
        /// The start angle of rod 1, degrees.
        A1 = "a1";
        /// The start angle of rod 2, degrees.
        A2 = "a2";
        /// The angular velocity of rod 1 at the start, rad/s.
        W1 = "w1";
        /// The angular velocity of rod 2 at the start, rad/s.
        W2 = "w2";
        /// The step size, s, and every error of a motion that is about no other field.
        Dt = "step size";
        MassRatio = "mu";
        /// The start angle of both rods, degrees.
        Angle = "angle";
        Speed = "speed";
        Field = "field";
        /// The message itself is no known command.
        Message = "message";
        /// The board has no panel with options.
        Panel = "panel";
    }
}

impl Field {
    /// Returns the settings with this field changed to `value`, in its unit. Refuses an angle that is
    /// beyond straight up or NaN, and a field that is not a setting. The angle that is not set is not
    /// checked.
    pub fn set(self, mut settings: Settings, value: f64) -> Result<Settings, Self> {
        let Settings {
            parameters,
            degrees: [a1, a2],
            velocities: [w1, w2],
        } = &mut settings;
        let is_angle = matches!(self, Self::A1 | Self::A2 | Self::Angle);
        if is_angle && is_beyond(value) {
            return Err(self);
        }

        match self {
            Self::M1 => parameters.m1 = value,
            Self::M2 => parameters.m2 = value,
            Self::L1 => parameters.l1 = value,
            Self::L2 => parameters.l2 = value,
            Self::G => parameters.g = value,
            Self::A1 => *a1 = value,
            Self::A2 => *a2 = value,
            Self::Angle => [*a1, *a2] = [value; 2],
            Self::W1 => *w1 = value,
            Self::W2 => *w2 = value,
            Self::MassRatio => parameters.m2 = parameters.m1 * value,
            _ => return Err(Self::Field),
        }
        Ok(settings)
    }
}

/// Refuses an angle beyond straight up, and an angle that is NaN.
pub fn in_range(settings: Settings) -> Result<Settings, Field> {
    match settings.degrees.map(is_beyond) {
        [true, _] => Err(Field::A1),
        [_, true] => Err(Field::A2),
        _ => Ok(settings),
    }
}

/// Returns true for an angle, degrees, that is beyond straight up or NaN.
fn is_beyond(degrees: f64) -> bool {
    !(-GREATEST_ANGLE..=GREATEST_ANGLE).contains(&degrees)
}

impl From<Error> for Field {
    /// Returns the field that an error of the kernel is about.
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
            Parameter::Method => Field::Method,
            _ => Field::Dt,
        }
    }
}
