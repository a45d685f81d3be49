//! The messages of a board to the host: a frame message after each drawn frame, and answers.

use core::fmt;

use double_pendulum::Method;
use serde::{Deserialize, Serialize};

use super::Field;
use crate::display::PanelReport;
use crate::job::Reading;
use crate::motion::{Planned, Settings};
use crate::scenes::{Report, SceneName};

/// A message to the host.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToHost {
    /// A drawn frame, sent after the picture was given to the driver of the panel.
    Frame(Frame),
    /// The board has restarted on its own, and counts frames from 0 again.
    ///
    /// Over USB no host receives this message, because a restart ends the connection. A host that
    /// opens the port asks with [`Command::AskRestart`](super::Command::AskRestart).
    Restarted(Restarted),
    /// An answer to the command with this number.
    Answer(u16, Answer),
}

/// An answer to a command.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// The command has been executed, or the scene ignores it.
    Done,
    /// The field that is wrong. It may also come after samples of a requested motion, which has
    /// then diverged ([`Field::Dt`]).
    Refused(Field),
    Status(Status),
    /// The plan of the scene; `None` if it shows no motion that is planned.
    Planned(Option<Planned>),
    Identity(Identity),
    /// A sample of the requested motion. The first one, with index 0, is the start.
    Sample {
        index: u32,
        reading: Reading,
    },
    /// The step of the request is longer than this one, s, the longest that resolves every motion
    /// of that energy. The samples follow all the same.
    StepTooLong(f64),
    /// The time of all `steps` steps together in processor cycles, including the call; on a
    /// Cortex-M0+ modulo 2^24. It is 0 without a cycle counter, as in QEMU.
    Measured {
        steps: u32,
        cycles: u32,
    },
    /// The last restart that the board made on its own since it was switched on or reset from
    /// outside.
    Restart(Option<Restarted>),
}

impl ToHost {
    pub fn frame(self) -> Option<Frame> {
        if let Self::Frame(frame) = self {
            Some(frame)
        } else {
            None
        }
    }

    pub fn restarted(self) -> Option<Restarted> {
        if let Self::Restarted(restarted) = self {
            Some(restarted)
        } else {
            None
        }
    }

    pub fn answer(self) -> Option<(u16, Answer)> {
        if let Self::Answer(request, answer) = self {
            Some((request, answer))
        } else {
            None
        }
    }
}

/// A drawn frame, in numbers. The host draws the same picture from them.
///
/// Its bytes, in order. A varint has 7 bits of an integer in each byte, the lowest first; bit 7 is
/// set in all bytes but the last. Floating-point numbers are IEEE 754, little-endian.
///
/// | bytes | field |
/// |---|---|
/// | 1, before COBS | [`VERSION`](super::VERSION) of the protocol |
/// | 1 | 0, the number of [`ToHost::Frame`] |
/// | varint, 1 to 5 each | `sequence`, `dropped`, `lost` |
/// | 1 | `scene`, its place in [`SceneName::ALL`], from 0 |
/// | 1 | `state`, its place in [`PlayState::ALL`], from 0 |
/// | 4, 4 | `mass_ratio`, `start_angle` |
/// | varint, 1 to 10 | `report.step` |
/// | 8 | `report.time` |
/// | 4, 4, 4, 4 | `report.state`: a1, a2, p1, p2 |
/// | 4 | `report.energy_error` |
/// | 1, or 1 and 4 | `report.horizon`: its number, and the time of the last two kinds |
/// | 1, or 1 and 1 and varint | `report.stepping`: 0; or 1, the method's number, the step count |
/// | varint, 1 to 5 each | `scene_cycles`, `busy_cycles` |
/// | 4, before COBS | the CRC-32 of all bytes above, little-endian |
///
/// COBS then replaces the zeros, and a zero before and after marks the ends
/// ([`encode`](super::encode)): at most 94 bytes in all. `report` is a [`Report`].
///
/// The numbers of all kinds are in `wire-14.txt` in this folder (test `link`). To add a field:
///
/// 1. Add it here, and to `Player::frame`. If only the board knows it, such as its cycles, add it
///    to `App::show`, and to `Show::expected` of the host's emulator.
/// 2. Raise [`VERSION`](super::VERSION) and, if a frame becomes longer than that, `MAX_MESSAGE`.
///    Run the tests `firmware link:: golden::` with `BLESS=1`, and name the version in
///    `firmware/README.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// The number of frames drawn since reset before this one; wraps. A gap is a frame lost on the
    /// way.
    pub sequence: u32,
    /// The number of ticks since reset whose frame was not drawn, because the board was late;
    /// wraps.
    pub dropped: u32,
    /// A lower bound of the number of bytes from the host that came faster than they were taken,
    /// since reset; wraps.
    pub lost: u32,
    pub scene: SceneName,
    pub state: PlayState,
    /// m2/m1 of the settings.
    pub mass_ratio: f32,
    /// The start angle of rod 1 in the settings, rad.
    pub start_angle: f32,
    /// The report of the scene, to the last bit.
    pub report: Report,
    /// The time to advance the scene and to draw it, in counts of the processor clock. QEMU does
    /// not model cycles; there it is the time by its own clock.
    pub scene_cycles: u32,
    /// The same for the whole previous frame, including the calls that pass it to the panel and to
    /// the link.
    pub busy_cycles: u32,
}

/// The state of the player. It is sufficient to play the scene again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    pub scene: SceneName,
    /// Angles are in degrees, other than in a [`Frame`].
    pub settings: Settings,
    /// The requested method; `None` leaves the choice to the plan.
    pub method: Option<Method>,
    /// The class of the processor, as an index in [`PROCESSORS`](crate::config::PROCESSORS).
    pub processor: u8,
    pub state: PlayState,
    pub steps: u32,
    /// The simulated time per real time; 1 is full speed.
    pub speed: f32,
    pub panel: PanelReport,
}

choice! {
    /// The state of the scene's time.
    PlayState {
        Playing = "playing";
        Paused = "paused";
        /// The motion is too fast for this chip or for the selected method.
        Stopped = "stopped";
    }
}

choice! {
    /// The reason why a board restarted.
    Cause {
        /// No frame was finished for [`WATCHDOG_SECONDS`](crate::config::WATCHDOG_SECONDS) or
        /// longer.
        Hang = "hang";
        /// The program reached a state that should be impossible.
        Panic = "panic";
        /// The processor took a fault.
        Fault = "fault";
    }
}

/// A restart, and the state of the program and of the scene before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Restarted {
    pub cause: Option<Cause>,
    /// The number of restarts in a row, including this one. After a minute without a restart the
    /// board counts from 0.
    pub restarts: u8,
    /// 0 if unknown, like the two below.
    pub pc: u32,
    pub lr: u32,
    pub cfsr: u32,
    /// The scene of the last frame that was shown.
    pub scene: SceneName,
    /// The tick of that frame, since the start of the scene.
    pub step: u64,
}

impl fmt::Display for Restarted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "scene {}, step {}", self.scene.name(), self.step)
    }
}

choice! {
    /// The name of a board.
    BoardName {
        /// The Stellaris LM3S6965 evaluation board.
        Lm3s6965evb = "lm3s6965evb";
        /// A board with an STM32F405 or F407.
        Stm32f405 = "stm32f405";
        /// The Raspberry Pi Pico.
        Pico = "pico";
    }
}

/// The identity of a board and of its program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    pub board: BoardName,
    pub hertz: u32,
    /// The CPUID register.
    pub processor: u32,
    /// The identification of the chip and its unique number: DID0 and DID1 of an LM3S6965, CHIP_ID
    /// of a Pico, IDCODE and the three words of the number of an STM32F405; otherwise zeros.
    pub chip: [u32; 4],
    /// The CRC-32/ISO-HDLC of the program in flash; 0 if it is not known.
    pub image: u32,
    /// 0 if it is not known.
    pub image_bytes: u32,
}
