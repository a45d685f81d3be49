//! A candidate: a method and step count, and the time for which it has been accurate.

use super::run::Directions;
use super::{Costs, Stepping};

/// A horizon must be this many times as long as another one to be worth a higher cost.
const WORTH: f32 = 1.1;

/// A method and step count in a race.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub stepping: Stepping,
    /// The cost of a frame.
    pub cost: f32,
    /// The last frame until which all frames were accurate.
    pub frames: u32,
    /// The largest bound of an error in these frames, divided by the tolerance.
    pub error: f32,
    /// True if no frame was inaccurate.
    pub is_alive: bool,
}

impl Candidate {
    /// Creates a candidate at the start.
    pub fn new(stepping: Stepping, costs: &Costs) -> Self {
        Self {
            stepping,
            cost: costs.of_frame(stepping),
            frames: 0,
            error: 0.0,
            is_alive: true,
        }
    }

    /// Records frame `frame`. `bound` is the bound of its error, divided by the tolerance; an unknown
    /// one, NaN, counts as too large. Frames that an earlier race has shown to be accurate stay so.
    pub fn note(&mut self, frame: u32, bound: f32) {
        self.is_alive &= bound <= 1.0;
        if self.is_alive && frame > self.frames {
            self.frames = frame;
            self.error = f32::max(self.error, bound);
        }
    }
}

/// Returns the best candidate for a problem of `frames` frames; `None` if no frame of any is
/// accurate. It is the cheapest one that reaches the end. If none does, it is the cheapest one whose
/// horizon is at most a tenth shorter than the longest.
pub(super) fn best(candidates: &[Candidate], frames: u32) -> Option<Candidate> {
    let longest = candidates.iter().map(|one| one.frames).max()?;
    let is_worth = |one: &&Candidate| {
        let is_long = WORTH * one.frames as f32 >= longest as f32;
        one.frames > 0 && (one.frames == longest || longest < frames && is_long)
    };
    let worth = candidates.iter().filter(is_worth);
    worth
        .min_by(|a, b| f32::total_cmp(&a.cost, &b.cost))
        .copied()
}

/// Returns the distance of two frames: the largest of the distances between their bobs 1, between
/// their bobs 2, and between their positions of bob 2 relative to bob 1. It is NaN if a direction
/// is.
///
/// `rods` are the lengths of the rods; the result has the same unit. The relative position counts
/// because the angles must be accurate, too: if both rods have opposite errors, bob 2 may be where
/// it belongs.
pub(super) fn distance(rods: [f32; 2], a: &Directions, b: &Directions) -> f32 {
    let difference = |rod: usize, axis: usize| rods[rod] * (a[rod][axis] - b[rod][axis]);
    let [bob1, relative] = [0, 1].map(|rod| [difference(rod, 0), difference(rod, 1)]);
    let bob2 = [bob1[0] + relative[0], bob1[1] + relative[1]];
    let [bob1, relative, bob2] = [bob1, relative, bob2].map(|[x, y]| x * x + y * y);
    libm::sqrtf(greater(greater(bob1, relative), bob2))
}

/// Returns the greater number, or NaN if either is NaN.
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b || a.is_nan() { a } else { b }
}
