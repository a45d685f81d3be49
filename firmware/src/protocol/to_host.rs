//! What a board sends: a frame after each that it has drawn, and answers.

use core::fmt;

use double_pendulum::Method;
use serde::{Deserialize, Serialize};

use super::Field;
use crate::display::PanelReport;
use crate::job::Reading;
use crate::motion::{Planned, Settings};
use crate::scenes::{Report, SceneName};

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum ToHost {
    /// One drawn frame, sent as soon as it is on the panel.
    Frame(Frame),
    /// The board has restarted by itself and plays on, from the start of its scene. The frames after it are counted from 0
    /// again. Over USB no host hears this message, because a restart ends the connection: a host
    /// asks with [`Command::AskRestart`](super::Command::AskRestart) when it has opened the port.
    Restarted(Restarted),
    /// To the command of this number.
    Answer(u16, Answer),
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// The command has been executed.
    Done,
    /// This is wrong: the command is not executed, and nothing was changed; or the motion cannot be computed, or not to its end.
    Refused(Field),
    /// What is played, and from what start; and the state of the panel.
    Status(Status),
    /// The plan of the scene; `None` if it shows no motion.
    Planned(Option<Planned>),
    /// What the board is.
    Identity(Identity),
    /// One sample of the motion asked for. The first one, index 0, is the start.
    Sample { index: u32, reading: Reading },
    /// The motion asked for follows, but its step is too long to resolve every motion of its energy; the longest that would, s.
    StepTooLong(f64),
    /// How long steps took: processor cycles, what calls them included; 0 where nothing counts cycles, as in QEMU, or the code
    /// does not stand there.
    Measured { steps: u32, cycles: u32 },
    /// The last restart that the board made by itself; `None` if it has made none since it was
    /// switched on or reset from outside.
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

    /// With its number.
    pub fn answer(self) -> Option<(u16, Answer)> {
        if let Self::Answer(request, answer) = self {
            Some((request, answer))
        } else {
            None
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Drawn frames since reset; a gap is a frame lost on the way, unless the board has [`Restarted`].
    pub sequence: u32,
    /// Ticks whose frame was never drawn, since reset.
    pub dropped: u32,
    /// Bytes from the host that were lost because they came faster than they were taken, since reset; at least so many.
    pub lost: u32,
    pub scene: SceneName,
    pub state: PlayState,
    pub mass_ratio: f32,
    /// Start angle of rod 1, rad; on the page that of both.
    pub start_angle: f32,
    /// The scene in numbers, to the last bit.
    pub report: Report,
    /// Counts of the processor clock that the scene took for this frame, moving and drawing: cycles on a chip; QEMU
    /// does not model cycles, there they say how much of the tick its own clock let pass.
    pub scene_cycles: u32,
    /// The same for all of the frame before, sending it to the panel and over the link included.
    pub busy_cycles: u32,
}

/// What is played, as far as it can be played again from it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Status {
    pub scene: SceneName,
    pub settings: Settings,
    /// The method that was asked for; `None` leaves it to the plan.
    pub method: Option<Method>,
    /// The class of the processor, by its place in [`PROCESSORS`](crate::config::PROCESSORS).
    pub processor: u8,
    pub state: PlayState,
    /// Ticks still to do before it stops, if it was told to do some.
    pub steps: u32,
    /// Simulated time per real time.
    pub speed: f32,
    /// The state of the panel.
    pub panel: PanelReport,
}

choice! {
    /// The state of the scene's time.
    PlayState {
        /// It advances.
        Playing = "playing";
        /// It stands still until a command lets it go on.
        Paused = "paused";
        /// It stands still because the motion is too fast for this chip, or for the method that the
        /// user has selected. Other settings or another scene start again.
        Stopped = "stopped";
    }
}

choice! {
    /// Why the board restarted.
    Cause {
        /// No frame was finished for too long.
        Hang = "hang";
        /// The program found itself in a state that cannot be.
        Panic = "panic";
        /// The processor could not go on.
        Fault = "fault";
    }
}

/// What is said of the program and the scene is how things stood before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Restarted {
    /// `None` where it cannot be found out.
    pub cause: Option<Cause>,
    /// Restarts in a row, this one included; the board forgets them after a minute without one.
    pub restarts: u8,
    /// Where the program was, as far as that could be found out, else 0.
    pub pc: u32,
    /// Where it would have returned to, likewise.
    pub lr: u32,
    /// The processor's Configurable Fault Status Register.
    pub cfsr: u32,
    /// The last frame shown: its scene and tick.
    pub scene: SceneName,
    pub step: u64,
}

/// Where it stood.
impl fmt::Display for Restarted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "scene {}, step {}", self.scene.name(), self.step)
    }
}

choice! {
    BoardName {
        /// Stellaris' evaluation board.
        Lm3s6965evb = "lm3s6965evb";
        /// ARM's MPS2 with image AN386.
        Mps2An386 = "mps2-an386";
        /// Any board with an STM32F405 or F407.
        Stm32f405 = "stm32f405";
        /// Raspberry Pi's Pico.
        Pico = "pico";
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Identity {
    pub board: BoardName,
    pub hertz: u32,
    /// What the processor says that it is: CPUID.
    pub processor: u32,
    /// What the chip says that it is, and its unique number; zeros where it has none.
    pub chip: [u32; 4],
    /// CRC-32 of the program in its flash, code and constants.
    pub image: u32,
    /// Bytes of that.
    pub image_bytes: u32,
}
