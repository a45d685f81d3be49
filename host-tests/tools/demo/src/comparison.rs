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

use emulator::host::Show;
use emulator::qemu::Screenshot;

/// The number of frames without an answer after which the host repeats the question.
const PATIENCE: u32 = TICK_RATE;
/// The largest number of ticks that one call advances the host's scene. A board may have played for
/// a long time, and the terminal must remain responsive while the host catches up.
const MOST_TICKS: u32 = 2000;

/// The comparison of a board with the host. The board's frames and reports of its scene go in, and
/// frames come out in the same order once they are compared. Its default is empty.
///
/// The compared numbers are the scene, the mass ratio, the start angle, and the report without
/// method and step count, bit by bit. A scene that is stopped on one side only is a difference,
/// too. Nothing else is compared.
///
/// The counts and the first difference are of all scenes together, since the comparison was made.
/// Later differences are only counted as skipped frames.
#[derive(Debug, Default)]
pub struct Comparison {
    /// The board's scene from its start, and the same scene on the host; `None` until the board has
    /// reported it.
    playing: Option<(Status, Show)>,
    /// The frames since the start that are not yet compared, oldest first.
    waiting: VecDeque<Frame>,
    /// The number of waiting frames that arrived before the board reported its scene. The board may
    /// have started another scene in between.
    unsure: usize,
    /// The difference in the first waiting frame, unless the board reports that it has started
    /// another scene.
    doubt: Option<String>,
    /// Counts the frames while the board's scene is unknown or in doubt.
    unknown: u32,
    /// The frame that arrived last.
    last: Option<Frame>,
    /// The number of frames that were identical.
    compared: u64,
    /// The number of frames that did not count: those discarded at a new start, and those that
    /// differ and may be of an earlier scene, or are or follow the first confirmed difference.
    skipped: u64,
    /// The first difference that was confirmed, in words.
    first: Option<String>,
}

impl Comparison {
    /// Takes a frame that has just arrived and waits for [`Comparison::follow`]. Returns true if
    /// the host must send a request for the board's scene: at the first frame without a known scene
    /// or with a difference in doubt, and after every 60 more. The answer goes to
    /// [`Comparison::status`].
    ///
    /// A frame of another scene, or with a smaller step number than the one before, is a new start.
    /// The scene is not known then until the next report, and the frames that still wait are
    /// discarded and count as skipped.
    pub fn frame(&mut self, frame: &Frame) -> bool {
        // Another scene or a smaller step number means that a new motion has begun on the board.
        let starts =
            |last: &Frame| frame.scene != last.scene || frame.report.step < last.report.step;
        if self.last.as_ref().is_none_or(starts) {
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

    /// Takes the board's report of its scene. If no scene is known, or if a difference is in doubt
    /// and the report is of another scene, the host starts the reported one. If a difference is in
    /// doubt and the report is of the same scene, the difference is real. In all other cases the
    /// report changes nothing. Reports are of the same scene if scene, settings, requested method
    /// and processor are equal.
    ///
    /// Frames that wait when the host starts a scene may be of the one before, so a difference in
    /// them is skipped. A scene that cannot start on the host counts as not known.
    pub fn status(&mut self, status: &Status) {
        // Only the start of the scene is compared. Its pause and speed do not matter.
        let start = Status {
            state: PlayState::Playing,
            steps: 0,
            speed: 1.0,
            panel: PanelReport::default(),
            ..*status
        };
        match (self.doubt.take(), &self.playing) {
            // The board still plays the same scene, so the difference is real.
            (Some(doubt), Some((playing, _))) if *playing == start => {
                self.first.get_or_insert(doubt);
            }
            // The answer confirms a scene that is already known.
            (None, Some(_)) => {}
            // The board plays another scene than assumed. Earlier waiting frames may belong to
            // either.
            _ => {
                self.playing = played(&start).ok().map(|show| (start, show));
                self.unsure = self.waiting.len();
            }
        }
    }

    /// Advances the host's scene to the oldest waiting frame, compares the frame and returns it. A
    /// returned frame that differs from the host's counts as skipped: it may be of an earlier scene
    /// ([`Comparison::status`]), or a difference is confirmed.
    ///
    /// Returns `None` if no frame waits, if the board has not reported its scene, if a difference
    /// is in doubt, or if the host's scene has not reached the frame yet; then it continues in the
    /// next call, because a call advances the host by at most 2000 ticks. A scene that has stopped
    /// on the host advances no more and is compared as it is.
    pub fn follow(&mut self) -> Option<Frame> {
        let (_, show) = self.playing.as_mut().filter(|_| self.doubt.is_none())?;
        let frame = self
            .waiting
            .front()
            .copied()
            .filter(|frame| is_reached(show, frame))?;
        let difference = difference(&frame, &show.player.frame());

        // A first difference is not reported at once. The board may have started another scene.
        if difference.is_some() && self.first.is_none() && self.unsure == 0 {
            self.doubt = difference;
            return None;
        }

        // Frames of a scene that has ended in the meantime are skipped, not faults.
        self.waiting.pop_front();
        self.unsure = self.unsure.saturating_sub(1);
        *(if difference.is_none() {
            &mut self.compared
        } else {
            &mut self.skipped
        }) += 1;
        Some(frame)
    }

    /// Returns the panel's picture, drawn from the current state of the host's scene, not from the
    /// board's numbers. `frame` only decides if there is a pause mark, so it must be the frame that
    /// [`Comparison::follow`] has just returned; a later call of that function may advance the
    /// scene. The picture is black if no scene plays on the host: before the board has reported its
    /// scene, at first and after each new start.
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

    /// Returns true if no frame waits to be compared, also before the first frame. A frame with a
    /// difference in doubt waits.
    pub fn is_settled(&self) -> bool {
        self.waiting.is_empty()
    }

    /// Returns true if no frame was identical, and none differs for certain: nothing is known.
    pub fn is_void(&self) -> bool {
        self.compared == 0 && self.first.is_none()
    }

    /// Returns the first number whose bits differ between board and host, in words, or `None` if no
    /// difference is confirmed. It stays the same from then on, also in later scenes.
    pub fn difference(&self) -> Option<&str> {
        self.first.as_deref()
    }
}

/// Writes the first confirmed difference or, without one, the number of identical frames and, if
/// they are not 0, those of the frames that were skipped and of those that still wait. It is one
/// line without a newline.
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

/// Returns the scene that the board plays from such a start, or the field that is not possible.
// A processor class that this host does not know is treated as the default one.
fn played(start: &Status) -> Result<Show, Field> {
    let processor = PROCESSORS
        .get(usize::from(start.processor))
        .copied()
        .unwrap_or(PROCESSOR);
    let mut show = Show::on(processor, SceneName::Page, &Settings::default())?;
    show.player.resume(start)?;
    Ok(show)
}

/// Advances the host's scene towards the step of `frame`. Returns true if it has arrived.
fn is_reached(show: &mut Show, frame: &Frame) -> bool {
    for _ in 0..MOST_TICKS {
        if show.report().step >= frame.report.step || show.player.is_still() {
            return true;
        }
        show.tick();
    }
    false
}

/// Returns the first number of the board's frame that differs from the host's.
fn difference(board: &Frame, here: &Frame) -> Option<String> {
    // Floating-point numbers are compared by their bits.
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
