//! How wrong a method is that is tried: how far two frames are apart, and in how many it was right.

use super::cost::Stepping;
use super::run::Directions;

/// A bob may be off by this much where the tolerance is the unit.
const TOLERATED: f32 = 1.0;

/// A method must be right for this much longer than another to be worth its cost.
const WORTH: f64 = 1.1;

/// How a method has fared so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub stepping: Stepping,
    /// The number of frames from the start that are accurate to the tolerance.
    pub accurate_frames: u32,
    /// The largest error measured in them, over the tolerance.
    pub error: f32,
    /// True if a frame was inaccurate, or if the candidate is excluded.
    pub failed: bool,
    /// The steps per frame of the fine run that it was compared with; `u32::MAX` if there was none.
    pub judge_steps: u32,
}

impl Candidate {
    pub fn new(stepping: Stepping) -> Self {
        Self {
            stepping,
            accurate_frames: 0,
            error: 0.0,
            failed: false,
            judge_steps: u32::MAX,
        }
    }

    /// Whether it is right for so much longer than `other` that it is worth more.
    pub fn has_longer_horizon(&self, other: &Self) -> bool {
        f64::from(self.accurate_frames) > WORTH * f64::from(other.accurate_frames)
    }

    /// Takes note of a frame with an error of about `error`, and hardly ever more than `bound`. NaN is
    /// wrong. After the first inaccurate frame nothing is noted.
    #[inline(never)] // one copy
    pub fn note(&mut self, error: f32, bound: f32) {
        if self.failed {
            return;
        }
        if bound <= TOLERATED {
            self.error = if error > self.error {
                error
            } else {
                self.error
            };
            self.accurate_frames += 1;
        } else {
            self.failed = true;
        }
    }
}

/// How far the farther of the two bobs is off, or bob 2 as seen from bob 1, where the rods are as long as `rods`, in their
/// unit; NaN if anything is.
///
/// The last keeps curves of the angles right, too: opposite errors of both may leave bob 2 where it belongs.
#[inline(never)] // one copy
pub(super) fn distance(rods: [f32; 2], a: &Directions, b: &Directions) -> f32 {
    let difference = |rod: usize, axis: usize| rods[rod] * (a[rod][axis] - b[rod][axis]);
    let [bob1, relative] = [0, 1].map(|rod| [difference(rod, 0), difference(rod, 1)]);
    let bob2 = [bob1[0] + relative[0], bob1[1] + relative[1]];
    let [bob1, relative, bob2] = [bob1, relative, bob2].map(|[x, y]| x * x + y * y);
    libm::sqrtf(greater(greater(bob1, relative), bob2))
}

/// The greater; NaN if either is.
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bob 2 is where both rods lead, and may be less far off than either.
    #[test]
    fn the_farthest_of_what_is_seen_counts() {
        let from = |a: Directions| distance([2.0, 3.0], &a, &[[0.0; 2]; 2]);
        assert_eq!(from([[1.0, 0.0], [0.0, 1.0]]), 13.0_f32.sqrt());
        assert_eq!(from([[0.5, 0.0], [1.0, 0.0]]), 4.0);
        assert_eq!(from([[3.0, 0.0], [-1.0, 0.0]]), 6.0);
        assert_eq!(from([[0.0, 1.0], [0.0, -2.0]]), 6.0);
        assert!(from([[0.0, f32::NAN], [0.0, 1.0]]).is_nan());
    }
}
