//! Every frame of a board beside the host's own. Frames do not tell all that a scene starts from, so the host asks the board;
//! the frames wait for its answer.

use std::collections::VecDeque;
use std::fmt;

use firmware::config::TICK_RATE;
use firmware::protocol::{Frame, Status};

use super::mirror::{Difference, Mirror, start_of};
use crate::emulator::qemu::Screenshot;

/// After this many frames without an answer the host asks again.
const PATIENCE: u32 = TICK_RATE;
/// The host catches up with a board that has long been playing by this many ticks at a time, so that the terminal goes on.
const MOST_TICKS: u32 = 2000;

#[derive(Debug, Default)]
pub struct Comparison {
    mirror: Option<Mirror>,
    /// What the mirror plays; `None` until the board has said it.
    playing: Option<Status>,
    /// Frames since the start that are not yet compared, oldest first.
    waiting: VecDeque<Frame>,
    /// How many of them came before the board said what it plays. It may have started something else in between.
    unsure: usize,
    /// A frame that differs, unless the board says that it has started something else.
    doubt: Option<Difference>,
    last: Option<Frame>,
    unanswered: Option<u32>,
    compared: u64,
    skipped: u64,
    first: Option<Difference>,
}

impl Comparison {
    /// Takes a frame that has just arrived; whether to ask the board what it plays.
    pub fn frame(&mut self, frame: &Frame) -> bool {
        let starts = |last: &Frame| frame.scene != last.scene || (frame.step.wrapping_sub(last.step) as i32) < 0;
        if self.last.as_ref().is_none_or(starts) {
            self.skipped += self.waiting.len() as u64;
            self.waiting.clear();
            (self.playing, self.doubt, self.unsure) = (None, None, 0);
        }
        self.last = Some(*frame);
        self.waiting.push_back(*frame);
        self.is_to_ask()
    }

    /// Whether an answer is wanted, and none on its way.
    fn is_to_ask(&mut self) -> bool {
        if self.playing.is_some() && self.doubt.is_none() {
            return false;
        }
        let asks = self.unanswered.is_none_or(|frames| frames >= PATIENCE);
        self.unanswered = Some(if asks { 0 } else { self.unanswered.unwrap_or(0) + 1 });
        asks
    }

    pub fn status(&mut self, status: &Status) {
        self.unanswered = None;
        let start = start_of(status);
        match self.doubt.take() {
            Some(doubt) if self.playing == Some(start) => {
                self.first.get_or_insert(doubt);
                return;
            }
            None if self.playing.is_some() => return,
            _ => {}
        }
        self.mirror = Mirror::of(&start).ok();
        self.playing = self.mirror.is_some().then_some(start);
        self.unsure = self.waiting.len();
    }

    /// Compares the next frame that waits; `None` if there is none, or the host is not there yet.
    pub fn follow(&mut self) -> Option<Frame> {
        let mirror = self.mirror.as_mut().filter(|_| self.playing.is_some() && self.doubt.is_none())?;
        let frame = self.waiting.front().copied().filter(|frame| mirror.advance(frame, MOST_TICKS))?;
        let difference = mirror.difference(&frame);
        if difference.is_some() && self.first.is_none() && self.unsure == 0 {
            self.doubt = difference;
            return None;
        }
        self.waiting.pop_front();
        self.unsure = self.unsure.saturating_sub(1);
        *(if difference.is_none() { &mut self.compared } else { &mut self.skipped }) += 1;
        Some(frame)
    }

    /// The panel, redrawn here as the compared `frame` shows it.
    pub fn panel(&mut self, frame: &Frame) -> Screenshot {
        self.mirror.as_mut().map_or_else(Screenshot::blank, |mirror| mirror.panel(frame))
    }

    pub fn is_settled(&self) -> bool {
        self.waiting.is_empty()
    }

    pub fn difference(&self) -> Option<Difference> {
        self.first
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(difference) = self.first {
            return difference.fmt(f);
        }
        write!(f, "{} frames, every bit the host's", grouped(self.compared))?;
        match self.skipped + self.waiting.len() as u64 {
            0 => Ok(()),
            skipped => write!(f, " ({} not compared)", grouped(skipped)),
        }
    }
}

/// With a comma after every three digits.
fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let groups = digits.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy);
    groups.collect::<Vec<_>>().join(",")
}
