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
    /// A drawn frame, sent after the picture was given to the driver of the panel, also if the
    /// driver failed. The panel may show it a little later, or not at all.
    Frame(Frame),
    /// The board has restarted on its own, and plays its scene from the start. Later frames are
    /// counted from 0 again. After more than 3 ([`MOST_RESTARTS`](crate::app::MOST_RESTARTS))
    /// restarts in a row, or if that scene is refused, it plays the first scene instead; only the
    /// frames show this.
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
    /// The command has been executed, or the scene ignores it. Commands that request something have
    /// the answers below instead.
    Done,
    /// The field that is wrong. The command is not executed, and nothing has changed. Of a
    /// requested motion it may also come after samples: the motion has diverged, and the field is
    /// [`Field::Dt`].
    Refused(Field),
    /// The scene and its settings, and the state of the panel.
    Status(Status),
    /// The plan of the scene; `None` if it shows no motion that is planned, or is too fast from its
    /// start.
    Planned(Option<Planned>),
    /// The identity of the board.
    Identity(Identity),
    /// A sample of the requested motion. The first one, with index 0, is the start. The last one
    /// has the index [`Request::samples`](crate::job::Request::samples), unless the motion is
    /// refused before, measured or replaced.
    Sample { index: u32, reading: Reading },
    /// The longest step that resolves every motion of the energy of the requested one, s. The step
    /// of the request is longer. The samples follow all the same. It is not sent if the step is
    /// short enough, or by the closed form.
    StepTooLong(f64),
    /// The time of all `steps` steps together in processor cycles, including the call; on a
    /// Cortex-M0+ modulo 2^24. `steps` is the requested number, at most 16
    /// ([`MOST_MEASURED_STEPS`](crate::config::MOST_MEASURED_STEPS)). `cycles` is 0 if there is no
    /// cycle counter, as in QEMU, or if the board does not have the code in the memory that the
    /// command names, flash or RAM; in the latter case no step is made.
    Measured { steps: u32, cycles: u32 },
    /// The last restart that the board made on its own; `None` if it has made none since it was
    /// switched on or reset from outside.
    Restart(Option<Restarted>),
}

impl ToHost {
    /// Returns the frame; `None` for another message.
    pub fn frame(self) -> Option<Frame> {
        if let Self::Frame(frame) = self {
            Some(frame)
        } else {
            None
        }
    }

    /// Returns the restart; `None` for another message.
    pub fn restarted(self) -> Option<Restarted> {
        if let Self::Restarted(restarted) = self {
            Some(restarted)
        } else {
            None
        }
    }

    /// Returns the answer and the number of its command; `None` for another message.
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
/// The numbers of all kinds are in `wire-12.txt` in this folder (test `link`). To add a field:
///
/// 1. Add it here, and to `Player::frame`. If only the board knows it, such as its cycles, add it
///    to `App::show`, and to `Show::expected` of the host's emulator.
/// 2. Raise [`VERSION`](super::VERSION) and, if a frame becomes longer than that, `MAX_MESSAGE`.
///    Run the tests `firmware link:: golden::` with `BLESS=1`, and name the version in
///    `firmware/README.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// The number of frames drawn since reset before this one; wraps. A gap means that a frame was
    /// lost on the way, unless the board has [`Restarted`].
    pub sequence: u32,
    /// The number of ticks of the clock since reset whose frame was not drawn, because the board
    /// was late; wraps.
    pub dropped: u32,
    /// A lower bound of the number of bytes from the host that were lost since reset because they
    /// came faster than they were taken; wraps.
    pub lost: u32,
    /// The scene that is shown.
    pub scene: SceneName,
    /// The state of the scene's time.
    pub state: PlayState,
    /// The mass ratio m2/m1 of the settings.
    pub mass_ratio: f32,
    /// The start angle of rod 1 in the settings, rad (not degrees), from the downward vertical,
    /// positive counter-clockwise. In the page's settings both rods have it.
    pub start_angle: f32,
    /// The report of the scene, to the last bit. While the scene is stopped, it does not change.
    pub report: Report,
    /// The time that the scene took for this frame, to advance by all ticks since the previous
    /// frame and to be drawn, in counts of the processor clock. They are cycles on a chip. QEMU
    /// does not model cycles; there they are the time by its own clock. It is 0 on a host.
    pub scene_cycles: u32,
    /// The same for the whole previous frame, including the calls that pass it to the panel and to
    /// the link; 0 in the first frame since reset. A transfer that continues after these calls, by
    /// interrupts, is not included.
    pub busy_cycles: u32,
}

/// The state of the player. It is sufficient to play the scene again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    pub scene: SceneName,
    /// The settings of the scene. Their angles are in degrees, other than in a [`Frame`].
    pub settings: Settings,
    /// The requested method; `None` leaves the choice to the plan.
    pub method: Option<Method>,
    /// The class of the processor, as an index in [`PROCESSORS`](crate::config::PROCESSORS).
    pub processor: u8,
    pub state: PlayState,
    /// The number of ticks left of a [`Step`](super::Command::Step) command; 0 without one.
    pub steps: u32,
    /// The simulated time per real time, 0.01 to 4, while the scene plays; 1 is full speed. A pause
    /// does not change it.
    pub speed: f32,
    /// The state of the panel.
    pub panel: PanelReport,
}

choice! {
    /// The state of the scene's time.
    PlayState {
        /// The scene advances.
        Playing = "playing";
        /// The scene is paused until a command lets it continue. It is also paused while a
        /// [`Step`](super::Command::Step) advances it.
        Paused = "paused";
        /// The scene has stopped because the motion is too fast for this chip, or for the method
        /// that the user has selected. Other settings or another scene start again. Such
        /// a scene is reported as stopped even if it is paused.
        Stopped = "stopped";
    }
}

choice! {
    /// The reason why a board restarted.
    Cause {
        /// The board finished no frame for
        /// [`WATCHDOG_SECONDS`](crate::config::WATCHDOG_SECONDS), 1 s, or longer.
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
    /// The cause; `None` if it is unknown.
    pub cause: Option<Cause>,
    /// The number of restarts in a row, including this one, at most 255. After 3,600 frames without
    /// a restart, a minute at full rate, the board counts from 0.
    pub restarts: u8,
    /// The program counter when the cause came; 0 if it is unknown.
    pub pc: u32,
    /// The return address (link register) at that moment; 0 if it is unknown.
    pub lr: u32,
    /// The processor's Configurable Fault Status Register; 0 if it is unknown.
    pub cfsr: u32,
    /// The scene of the last frame that was shown; before the first frame, the scene that was
    /// started.
    pub scene: SceneName,
    /// The tick of that frame: the number of ticks of the scene since its start; 0 before the first
    /// frame.
    pub step: u64,
}

/// Writes the scene and the tick of the last frame, such as `scene page, step 60`, without a line
/// feed.
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
        /// The ARM MPS2 with image AN386.
        Mps2An386 = "mps2-an386";
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
    /// The frequency of the processor clock, Hz.
    pub hertz: u32,
    /// The CPUID register of the processor.
    pub processor: u32,
    /// The identification of the chip and its unique number: DID0 and DID1 of an LM3S6965, CHIP_ID
    /// of a Pico, IDCODE and the three words of the number of an STM32F405. The other words are
    /// zeros, and so are all of an emulated STM32F405 and of an MPS2.
    pub chip: [u32; 4],
    /// The CRC-32/ISO-HDLC of the program in flash, code and constants; 0 if it is not known.
    pub image: u32,
    /// The size of the program, bytes; 0 if it is not known.
    pub image_bytes: u32,
}
