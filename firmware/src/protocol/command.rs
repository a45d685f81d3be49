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
/// [`Answer::Refused`](super::Answer::Refused) with the field that is wrong. A command that is
/// ignored counts as executed. A command that starts a scene is impossible if the scene cannot
/// start with the settings. Unless stated below, the field is then that of the settings that the
/// kernel refuses ([`Field::from`]).
///
/// A scene that starts keeps the pause, the ticks left of a [`Step`](Self::Step), the speed and the
/// requested method. If it cannot start by that method, it follows its plan. A motion that is too
/// fast is not refused: its scene starts, and is [`Stopped`](super::PlayState::Stopped).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Command {
    /// Selects the next larger mass ratio m2/m1 of [`MASS_RATIOS`](crate::config::MASS_RATIOS), by
    /// another m2, and starts the scene again. A ratio of 100, the largest of them, or more stays,
    /// and the scene starts again all the same.
    Heavier,
    /// Selects the next smaller mass ratio in the same way. A ratio of 0.01, the smallest, or less
    /// stays.
    Lighter,
    /// Turns both start angles by one [`ANGLE_STEP`](crate::config::ANGLE_STEP), 1 degree,
    /// clockwise, and starts the scene again. Each angle stops at -180 degrees on its own. A scene
    /// without start angles ignores the command, and continues.
    TurnLeft,
    /// Turns both start angles by one step counter-clockwise, each to 180 degrees at most, in the
    /// same way.
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
    /// It accepts `M1` to `W2`, `MassRatio` (by another m2), `Angle` (both start angles) and
    /// `Speed`. Another field is refused with [`Field::Field`]. A value with which the scene cannot
    /// start, an angle that is NaN or beyond straight up (pi rad either way), and a speed that is
    /// not 0.01 to 4 after rounding to hundredths, are refused with their own field. Any
    /// other value that the scene does not use is accepted, also NaN: a velocity in `flips`, and a
    /// velocity, a length or the gravity in `frequencies`.
    Set {
        /// The parameter.
        field: Field,
        /// The value, in the unit of the field; an angle in rad, not in degrees. All but the speed
        /// are stored in `f32`.
        value: f64,
    },
    /// Starts the scene again by this method and no other; `None` leaves the choice to the plan.
    /// Later starts use the method where they can, and otherwise follow their plan.
    ///
    /// Refused with [`Field::Method`] if the method is not in [`Method::DRAWN`], or if the present
    /// scene cannot start by it: the method refuses the motion, or costs more than the budget of a
    /// frame, in `butterfly` more than half of it. Figures, `small-*` and `upright` do not use it,
    /// but start again.
    Method(Option<Method>),
    /// Pauses the scene (`true`) or lets it continue. It ends a [`Step`](Self::Step). A stopped
    /// scene stays stopped.
    Pause(bool),
    /// Pauses the scene, or lets it continue if it is paused, also during a [`Step`](Self::Step),
    /// which ends.
    TogglePause,
    /// Advances the scene by this number of ticks, one in each tick of the clock at any speed, and
    /// then leaves it paused; 0 pauses it at once. It replaces the rest of an earlier one. A
    /// stopped scene stays stopped; the next one that starts is paused, and makes these ticks.
    Step(u32),
    /// Requests the scene, its settings and its state ([`Answer::Status`](super::Answer::Status)).
    /// Changes nothing.
    Ask,
    /// Requests the plan of the scene, as far as it is known
    /// ([`Answer::Planned`](super::Answer::Planned)). Changes nothing.
    AskPlan,
    /// Requests the identity of the board ([`Answer::Identity`](super::Answer::Identity)). Changes
    /// nothing.
    Identify,
    /// Requests the samples of this motion ([`Answer::Sample`](super::Answer::Sample)). They are
    /// computed in the time that frames leave free. The scene continues. A job in progress is
    /// replaced, and sends no more samples.
    ///
    /// Refused with [`Field::Method`] if the application lacks the method, and otherwise with the
    /// field that the kernel refuses, such as [`Field::Dt`]; then an earlier job continues.
    Simulate(Request),
    /// Requests the time of this number of further steps of the last requested motion
    /// ([`Answer::Measured`](super::Answer::Measured)). They are made without a break and with
    /// interrupts off. A number above
    /// [`MOST_MEASURED_STEPS`](crate::config::MOST_MEASURED_STEPS), 16, counts as 16. No sample of
    /// that motion follows, also after 0 steps, but it can be measured again. A motion that has
    /// ended or diverged can be measured, too. Refused with [`Field::Message`] if no
    /// [`Simulate`](Self::Simulate) has been executed since reset.
    Measure {
        /// The number of steps.
        steps: u32,
        /// True to run the code of the steps in RAM, false to run it in flash.
        in_ram: bool,
    },
    /// Drives the panel as this controller from the next frame on; `None` identifies it. The choice
    /// is kept across every reset that leaves memory powered. Refused with [`Field::Panel`] if the
    /// panel has no choice of controllers. Not checked: the panel has this controller.
    Panel(Option<Controller>),
    /// Plays a scene with these settings, whose angles are in degrees. They are set all at once,
    /// because a part of them alone may be impossible. Angles beyond 180 degrees either way, and
    /// NaN, are refused with [`Field::A1`] or [`Field::A2`].
    Play(SceneName, Settings),
    /// Requests the last restart that the board made on its own
    /// ([`Answer::Restart`](super::Answer::Restart)). Changes nothing.
    AskRestart,
}

/// The mark byte before every command. A message to the host begins with a smaller number, which is
/// its kind.
const TO_CHIP: u8 = 0x80;

/// Encodes a command for the wire, with mark byte, version, CRC and delimiters. Returns the used
/// part of `wire`, as [`encode`](super::encode) does; every command fits. `request` is a number
/// that every answer to it repeats; any number is allowed. The values of the command are not
/// checked.
pub fn encode_command(request: u16, command: Command, wire: &mut [u8; MAX_WIRE]) -> &[u8] {
    encode(&(TO_CHIP, request, command), wire)
}

/// Returns the number of an intact command, and the command. `message` is without version and CRC,
/// as [`Decoder::push`](super::Decoder::push) returns it.
///
/// The command is `None` if it is unknown, incomplete, or followed by further bytes. If not even
/// the number can be read, it is 0. The whole result is `None` if the message is not a command,
/// that is if it does not begin with the mark byte 0x80. The values of the command are not checked:
/// they may be NaN.
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
        /// The requested method.
        Method = "method";
        /// The mass of bob 1, kg.
        M1 = "m1";
        /// The mass of bob 2, kg.
        M2 = "m2";
        /// The length of rod 1, m.
        L1 = "l1";
        /// The length of rod 2, m.
        L2 = "l2";
        /// The gravity, m/s^2.
        G = "g";
        /// The start angle of rod 1, rad.
        A1 = "a1";
        /// The start angle of rod 2, rad.
        A2 = "a2";
        /// The angular velocity of rod 1 at the start, rad/s.
        W1 = "w1";
        /// The angular velocity of rod 2 at the start, rad/s.
        W2 = "w2";
        /// The step size of a requested motion, s. Also a scene whose steps are too long for its
        /// motion, a motion that diverged, and every error that is about no other field.
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
        /// Also [`Command::Measure`] without a requested motion.
        Message = "message";
        /// The board has no panel with a choice of controllers.
        Panel = "panel";
    }
}

impl From<Error> for Field {
    /// Returns the field that an error of the kernel is about. A momentum counts as the angular
    /// velocity of the same number. An error without such a field, and a motion that diverged,
    /// count as a wrong step size, [`Field::Dt`].
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
