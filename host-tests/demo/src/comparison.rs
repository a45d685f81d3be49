//! The comparison of every frame of a board with the host's own frame.
//!
//! Frames do not contain everything that a scene starts from, so the host asks the board. The
//! frames wait for the answer. Then the host starts the same scene code with the board's settings,
//! and moves and draws it here.

use std::collections::VecDeque;
use std::fmt;

use firmware::config::{PROCESSOR, PROCESSORS, TICK_RATE};
use firmware::display::PanelReport;
use firmware::graphics::text;
use firmware::motion::Settings;
use firmware::protocol::{Field, Frame, PlayState, Status};
use firmware::scenes::SceneName;
use indicatif::HumanCount;

use boards::host::Show;
use boards::qemu::Screenshot;

const PATIENCE: u32 = TICK_RATE;
/// A board may have played for a long time, and the terminal must remain responsive while the host
/// catches up.
const MOST_TICKS: u32 = 2000;

/// The comparison of a board with the host, bit by bit, without method and step count.
#[derive(Debug, Default)]
pub struct Comparison {
    playing: Option<(Status, Show)>,
    /// The ticks of the board's clock at which the scene began, and which the host has reached.
    began: u32,
    reached: u32,
    waiting: VecDeque<Frame>,
    /// The waiting frames that arrived before the board reported its scene. They may be of another
    /// one.
    unsure: usize,
    /// The difference in the first waiting frame, unless the board has started another scene.
    doubt: Option<String>,
    unknown: u32,
    last: Option<Frame>,
    compared: u64,
    /// The frames discarded at a new start, and those that are or follow a difference.
    skipped: u64,
    first: Option<String>,
}

impl Comparison {
    /// Takes a frame. Returns true if the host must ask for the board's scene. A frame of another
    /// scene, or with a smaller step number, is a new start.
    pub fn frame(&mut self, frame: &Frame) -> bool {
        let starts =
            |last: &Frame| frame.scene != last.scene || frame.report.step < last.report.step;
        if self.last.as_ref().is_none_or(starts) {
            // A scene that was joined in its course has played at full speed.
            self.began = self.last.as_ref().map_or_else(|| full_speed(frame), clock);
            self.skipped += self.waiting.len() as u64;
            self.waiting.clear();
            self.playing = None;
            self.doubt = None;
            self.unsure = 0;
            self.unknown = 0;
        }

        self.last = Some(*frame);
        self.waiting.push_back(*frame);

        // The question is sent with the first frame and repeated if no answer comes.
        let is_unknown = self.playing.is_none() || self.doubt.is_some();
        self.unknown = if is_unknown { self.unknown + 1 } else { 0 };
        self.unknown % PATIENCE == 1
    }

    /// A difference in doubt is real if the report is of the same scene.
    pub fn status(&mut self, status: &Status) {
        // Only the start of the scene is compared. Its pause and speed do not matter.
        let start = Status {
            state: PlayState::Playing,
            steps: 0,
            speed: 1.0,
            panel: PanelReport {
                name: status.panel.name,
                ..PanelReport::default()
            },
            ..*status
        };
        match (self.doubt.take(), &self.playing) {
            (Some(doubt), Some((playing, _))) if *playing == start => {
                self.first.get_or_insert(doubt);
            }
            (None, Some(_)) => {}
            (doubt, _) => {
                if let (Some(_), Some(frame)) = (doubt, self.waiting.front()) {
                    self.began = full_speed(frame);
                }
                self.reached = self.began;
                self.playing = played(&start).ok().map(|show| (start, show));
                self.unsure = self.waiting.len();
            }
        }
    }

    /// Advances the host's scene to the oldest waiting frame and compares the two.
    pub fn follow(&mut self) -> Option<Frame> {
        let (_, show) = self.playing.as_mut().filter(|_| self.doubt.is_none())?;
        let frame = self
            .waiting
            .front()
            .copied()
            .filter(|frame| is_reached(show, &mut self.reached, frame))?;
        let difference = difference(&frame, &show.player.frame());

        // A first difference is not reported at once. The board may have started another scene.
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

    /// Returns the panel's picture, drawn from the host's scene, not from the board's numbers.
    pub fn panel(&mut self, frame: &Frame) -> Screenshot {
        let Some((_, show)) = &mut self.playing else {
            return Screenshot::black();
        };
        show.player.draw();
        if frame.state == PlayState::Paused {
            text::pause_mark(&mut show.player.canvas);
        }
        Screenshot::from(&show.player.canvas)
    }

    pub fn is_settled(&self) -> bool {
        self.waiting.is_empty()
    }

    pub fn is_void(&self) -> bool {
        self.compared == 0 && self.first.is_none()
    }

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
        let others = [
            (self.skipped, "skipped at restarts"),
            (self.waiting.len() as u64, "waiting for the host"),
        ];
        let others: Vec<_> = others
            .into_iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{} {what}", HumanCount(count)))
            .collect();
        if others.is_empty() {
            return Ok(());
        }
        write!(f, " ({})", others.join(", "))
    }
}

// A processor class that this host does not know is treated as the default one.
fn played(start: &Status) -> Result<Show, Field> {
    let processor = PROCESSORS
        .get(usize::from(start.processor))
        .copied()
        .unwrap_or(PROCESSOR);
    let format = start.panel.name.format();
    let mut show = Show::in_format(format, processor, SceneName::Page, &Settings::default())?;
    show.player.resume(start)?;
    Ok(show)
}

/// Returns the number of ticks of the board's clock until this frame.
fn clock(frame: &Frame) -> u32 {
    frame.sequence.wrapping_add(frame.dropped)
}

/// Returns the tick in which the scene of this frame began if it has played at full speed.
fn full_speed(frame: &Frame) -> u32 {
    clock(frame).wrapping_sub(frame.report.step as u32)
}

/// Advances the host's scene by the ticks of the board's clock, because the board plans in each of
/// them, and by as many ticks of the scene in each as the board's speed has made. If the clock does
/// not fit, as after a reset, each makes one tick of the scene.
fn is_reached(show: &mut Show, reached: &mut u32, frame: &Frame) -> bool {
    for _ in 0..MOST_TICKS {
        let due = frame.report.step.saturating_sub(show.report().step) as u32;
        let ticks = clock(frame).wrapping_sub(*reached);
        let is_paused = frame.state == PlayState::Paused;
        let is_counted = !is_paused && (1..=PATIENCE * PATIENCE).contains(&ticks);
        if show.player.is_still() || due == 0 && !is_counted {
            *reached = clock(frame);
            return true;
        }
        if is_counted {
            *reached = reached.wrapping_add(1);
            show.advance(due / ticks);
        } else {
            show.advance(1);
        }
    }
    false
}

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

    // Only the first difference is reported; those after it follow from it.
    let sequence = board.sequence;
    let step = board.report.step;
    Some(format!(
        "frame {sequence}, step {step}: {number} is {board_bits:#x} on the board, {here_bits:#x} \
         on the host"
    ))
}
