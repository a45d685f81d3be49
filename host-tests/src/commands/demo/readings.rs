//! What the terminal shows beside the panel: the latest numbers and a little of their past.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use firmware::config::TICK_RATE;
use firmware::protocol::{Frame, Status};

use super::comparison::Comparison;
use super::plot::{self, Moment};
use super::summary::Summary;
use crate::emulator::qemu::LogLine;
use crate::link::Counts;

/// How many energy errors are remembered, each the largest of half a second.
const PAST: usize = 240;
/// Frames in half a second.
const FRAMES_PER_BAR: u32 = TICK_RATE / 2;
/// How many lines of the log are remembered.
const LINES: usize = 100;
/// The time over which frames per second are counted.
const RATE_SPAN: Duration = Duration::from_secs(1);

/// The latest of everything.
#[derive(Debug, Default)]
pub struct Readings {
    /// The latest frame; `None` until one has come.
    pub frame: Option<Frame>,
    /// The angles that the motion started from, degrees; `None` until the board has told.
    pub start: Option<[f32; 2]>,
    /// What the link has been through.
    pub counts: Counts,
    /// The largest size of the energy error in each half second, oldest first.
    pub energy_errors: VecDeque<f32>,
    /// Both angles over the last [`plot::SPAN`], oldest first.
    pub angles: VecDeque<Moment>,
    /// Lines of the log, oldest first.
    pub lines: VecDeque<LogLine>,
    /// The frames beside the host's own.
    pub comparison: Comparison,
    /// The run so far.
    pub summary: Summary,
    /// Whether what they mean is shown in their place.
    pub help: bool,
    /// Frames that the latest of the energy errors stands for.
    frames_in_bar: u32,
    pub(super) arrivals: VecDeque<Instant>,
}

impl Readings {
    /// Takes a frame that has just arrived; whether the board is to be asked what it plays.
    pub fn frame(&mut self, frame: Frame) -> bool {
        if self.frame.is_none_or(|last| frame.scene != last.scene || frame.time < last.time) {
            self.start = None;
            self.energy_errors.clear();
            self.angles.clear();
        }
        self.frame = Some(frame);
        self.summary.frame(&frame);
        let error = frame.energy_error.abs();
        match self.energy_errors.back_mut() {
            Some(largest) if self.frames_in_bar < FRAMES_PER_BAR => *largest = largest.max(error),
            _ => {
                push(&mut self.energy_errors, error, PAST);
                self.frames_in_bar = 0;
            }
        }
        self.frames_in_bar += 1;
        let [a1, a2, ..] = frame.state.map(|number| f64::from(number).to_degrees());
        if self.angles.back().is_none_or(|last| frame.time > last.time) {
            self.angles.push_back(Moment { time: frame.time, angles: [a1, a2] });
        }
        while self.angles.front().is_some_and(|first| frame.time - first.time > plot::SPAN) {
            self.angles.pop_front();
        }
        let now = Instant::now();
        self.arrivals.push_back(now);
        while self.arrivals.front().is_some_and(|&arrival| now - arrival > RATE_SPAN) {
            self.arrivals.pop_front();
        }
        self.comparison.frame(&frame)
    }

    /// Takes what the board says that it plays: frames tell of rod 1 only.
    pub fn status(&mut self, status: &Status) {
        self.start = Some(status.degrees);
        self.comparison.status(status);
    }

    /// Takes a line of the log.
    pub fn line(&mut self, line: LogLine) {
        self.summary.line(&line);
        push(&mut self.lines, line, LINES);
    }

    /// The report at the end.
    pub fn report(&self) -> String {
        format!("{}\nbits                  {}", self.summary.report(self.counts), self.comparison)
    }

    /// Frames that arrived in the last second.
    pub fn rate(&self) -> usize {
        self.arrivals.iter().filter(|arrival| arrival.elapsed() <= RATE_SPAN).count()
    }
}

/// Keeps the last `most`.
fn push<T>(queue: &mut VecDeque<T>, item: T, most: usize) {
    if queue.len() >= most {
        queue.pop_front();
    }
    queue.push_back(item);
}
