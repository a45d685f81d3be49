//! Every frame of a board beside the host's own. Frames do not tell all that a scene starts from, so the host asks the board;
//! the frames wait for its answer, and the same scene code, started as the board says, is moved and drawn here.

use std::collections::VecDeque;
use std::fmt;

use firmware::config::{PROCESSOR, PROCESSORS, TICK_RATE};
use firmware::display::PanelReport;
use firmware::graphics::{Canvas, text};
use firmware::motion::Settings;
use firmware::protocol::{Field, Frame, PlayState, Status};
use firmware::scenes::SceneName;
use indicatif::HumanCount;

use crate::emulator::host::Show;
use crate::emulator::qemu::Screenshot;

/// After this many frames without an answer the host asks again.
const PATIENCE: u32 = TICK_RATE;
/// The host catches up with a board that has long been playing by this many ticks at a time, so that the terminal goes on.
const MOST_TICKS: u32 = 2000;

#[derive(Debug, Default)]
pub struct Comparison {
    /// What the board plays, from its start, and played here; `None` until the board has said it.
    playing: Option<(Status, Show)>,
    /// Frames since the start that are not yet compared, oldest first.
    waiting: VecDeque<Frame>,
    /// How many of them came before the board said what it plays. It may have started something else in between.
    unsure: usize,
    /// A number of the first of them that differs, unless the board says that it has started something else.
    doubt: Option<String>,
    /// Frames for which it has not been known what the board plays, or been in doubt.
    unknown: u32,
    last: Option<Frame>,
    compared: u64,
    skipped: u64,
    first: Option<String>,
}

impl Comparison {
    /// Takes a frame that has just arrived; whether to ask the board what it plays.
    pub fn frame(&mut self, frame: &Frame) -> bool {
        let starts =
            |last: &Frame| frame.scene != last.scene || frame.report.step < last.report.step;
        if self.last.as_ref().is_none_or(starts) {
            self.skipped += self.waiting.len() as u64;
            self.waiting.clear();
            (self.playing, self.doubt, self.unsure, self.unknown) = (None, None, 0, 0);
        }
        self.last = Some(*frame);
        self.waiting.push_back(*frame);
        let is_unknown = self.playing.is_none() || self.doubt.is_some();
        self.unknown = if is_unknown { self.unknown + 1 } else { 0 };
        self.unknown % PATIENCE == 1
    }

    pub fn status(&mut self, status: &Status) {
        // What is played by its start alone: how its time goes is another matter.
        let start = Status {
            state: PlayState::Playing,
            steps: 0,
            speed: 1.0,
            panel: PanelReport::default(),
            ..*status
        };
        match (self.doubt.take(), &self.playing) {
            (Some(doubt), Some((playing, _))) if *playing == start => {
                self.first.get_or_insert(doubt);
            }
            (None, Some(_)) => {}
            _ => {
                self.playing = played(&start).ok().map(|show| (start, show));
                self.unsure = self.waiting.len();
            }
        }
    }

    /// Compares the next frame that waits; `None` if there is none, or the host is not there yet.
    pub fn follow(&mut self) -> Option<Frame> {
        let (_, show) = self.playing.as_mut().filter(|_| self.doubt.is_none())?;
        let frame = self
            .waiting
            .front()
            .copied()
            .filter(|frame| is_reached(show, frame))?;
        let difference = difference(&frame, &show.player.frame());
        if difference.is_some() && self.first.is_none() && self.unsure == 0 {
            self.doubt = difference;
            return None;
        }
        self.waiting.pop_front();
        self.unsure = self.unsure.saturating_sub(1);
        *(if difference.is_none() {
            &mut self.compared
        } else {
            &mut self.skipped
        }) += 1;
        Some(frame)
    }

    /// The panel, redrawn here as the compared `frame` shows it.
    pub fn panel(&self, frame: &Frame) -> Screenshot {
        let mut canvas = self
            .playing
            .as_ref()
            .map_or(Canvas::default(), |(_, show)| show.frame());
        if frame.state == PlayState::Paused {
            text::pause_mark(&mut canvas);
        }
        Screenshot::from(&canvas)
    }

    pub fn is_settled(&self) -> bool {
        self.waiting.is_empty()
    }

    /// The first number that board and host do not have alike, by its bits.
    pub fn difference(&self) -> Option<&str> {
        self.first.as_deref()
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(difference) = &self.first {
            return f.write_str(difference);
        }
        write!(
            f,
            "{} frames, all identical to the host",
            HumanCount(self.compared)
        )?;
        match self.skipped + self.waiting.len() as u64 {
            0 => Ok(()),
            skipped => write!(f, " ({} skipped at restarts)", HumanCount(skipped)),
        }
    }
}

/// What the board plays from such a start; the field of it that cannot be.
fn played(start: &Status) -> Result<Show, Field> {
    let processor = PROCESSORS
        .get(usize::from(start.processor))
        .copied()
        .unwrap_or(PROCESSOR);
    let mut show = Show::on(processor, SceneName::Page, &Settings::default())?;
    show.player.resume(start)?;
    Ok(show)
}

/// Goes on towards the step of `frame`; whether it is there.
fn is_reached(show: &mut Show, frame: &Frame) -> bool {
    for _ in 0..MOST_TICKS {
        if show.report().step >= frame.report.step || show.player.is_still() {
            return true;
        }
        show.tick();
    }
    false
}

/// The first number of the board's frame that is not the host's.
fn difference(board: &Frame, here: &Frame) -> Option<String> {
    let numbers = |frame: &Frame| {
        let report = &frame.report;
        let [a1, a2, p1, p2] =
            <[f32; 4]>::from(report.state).map(|number| u64::from(number.to_bits()));
        [
            ("scene", frame.scene as u64),
            ("step", report.step),
            ("time", report.time.to_bits()),
            ("mass ratio", frame.mass_ratio.to_bits().into()),
            ("start angle", frame.start_angle.to_bits().into()),
            ("a1", a1),
            ("a2", a2),
            ("p1", p1),
            ("p2", p2),
            ("energy error", report.energy_error.to_bits().into()),
            ("horizon", report.horizon.verified().to_bits().into()),
            ("open horizon", report.horizon.is_open().into()),
            ("stop", (frame.state == PlayState::Stopped).into()),
        ]
    };
    let mut pairs = numbers(board).into_iter().zip(numbers(here));
    let ((number, board_bits), (_, here_bits)) = pairs.find(|(board, here)| board != here)?;
    let (sequence, step) = (board.sequence, board.report.step);
    Some(format!(
        "frame {sequence}, step {step}: {number} is {board_bits:#x}, the host's {here_bits:#x}"
    ))
}
