//! Candidates: the number of accurate frames of a method and step count, and the distance of two
//! frames.

use super::cost::Stepping;
use super::run::Directions;

/// The largest allowed error, in units of the tolerance.
const TOLERATED: f32 = 1.0;

/// A horizon must be this many times as long as another one to be worth a higher cost.
const WORTH: f64 = 1.1;

/// A method and step count with the accuracy that was measured for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    /// The method and its number of steps per frame.
    pub stepping: Stepping,
    /// The number of frames from the start that are within the tolerance. The start itself, frame
    /// 0, is not counted, so that this is also the index of the last accurate frame.
    pub accurate_frames: u32,
    /// The largest estimated error in these frames, divided by the tolerance; 0 if there are none.
    pub error: f32,
    state: CandidateState,
    /// The steps per frame of the fine run of the reference; `u32::MAX` without a reference.
    pub judge_steps: u32,
    /// The number of finer runs that the candidate is compared with. It is 0 with a reference, and
    /// until [`Trial::new`](super::trial::Trial::new) sets it.
    pub finer_runs: u8,
}

/// The state of a candidate in its trial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum CandidateState {
    /// Every compared frame was accurate.
    Accurate,
    /// A frame was inaccurate. The frames before it still count.
    Failed,
    /// The candidate is not part of the trial, or no longer.
    Excluded,
}

impl Candidate {
    /// Creates a candidate that takes part in its trial and has no frames yet. `stepping` is not
    /// checked.
    pub fn new(stepping: Stepping) -> Self {
        Self {
            stepping,
            accurate_frames: 0,
            error: 0.0,
            state: CandidateState::Accurate,
            judge_steps: u32::MAX,
            finer_runs: 0,
        }
    }

    /// Returns true if the candidate is part of the trial and every compared frame was accurate.
    /// Before the first frame is compared, it is true as well.
    pub fn is_accurate(&self) -> bool {
        self.state == CandidateState::Accurate
    }

    /// Returns true if a frame was inaccurate and the candidate is not excluded.
    pub fn has_failed(&self) -> bool {
        self.state == CandidateState::Failed
    }

    /// Returns true if the candidate was measured better than `other`: with a reference in 64 bits
    /// instead of finer runs, or with more finer runs.
    pub fn is_measured_better(&self, other: &Self) -> bool {
        // No finer runs mean a reference, which is better than any number of them: 0 - 1 wraps.
        let [own, known] = [self, other].map(|one| one.finer_runs.wrapping_sub(1));
        own > known
    }

    /// Excludes the candidate from the rest of the trial. Its accurate frames still count.
    pub fn exclude(&mut self) {
        self.state = CandidateState::Excluded;
    }

    /// Returns true if the candidate has more than 1.1 times ([`WORTH`]) as many accurate frames as
    /// `other`, which is worth a higher cost. False if neither has any.
    pub fn has_longer_horizon(&self, other: &Self) -> bool {
        f64::from(self.accurate_frames) > WORTH * f64::from(other.accurate_frames)
    }

    /// Records the next frame.
    ///
    /// `error` is an estimate of its error, and `bound` is an upper bound that is exceeded only in
    /// rare cases. Both are in units of the tolerance. The frame is accurate if the bound is at
    /// most 1 ([`TOLERATED`]); then it is counted, and the largest `error` is kept. If `error` is
    /// NaN, `bound` must be NaN too, which counts as inaccurate. The first inaccurate frame makes
    /// the candidate fail. After that, or if the candidate is excluded, nothing is recorded.
    pub fn note(&mut self, error: f32, bound: f32) {
        if !self.is_accurate() {
            return;
        }

        // The first frame beyond the bound ends the horizon of the candidate.
        if bound <= TOLERATED {
            self.error = greater(self.error, error);
            self.accurate_frames += 1;
        } else {
            self.state = CandidateState::Failed;
        }
    }
}

/// Returns the distance of two frames: the largest of the distances between their bobs 1, between
/// their bobs 2, and between their positions of bob 2 relative to bob 1.
///
/// `rods` are the lengths of the rods; the result has the same unit. It is NaN if any direction is
/// NaN. The relative position is included so that the angles are accurate, too: if both rods have
/// opposite errors, bob 2 may be where it belongs.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Method;

    /// Returns a candidate that has not been compared yet.
    fn candidate() -> Candidate {
        Candidate::new(Stepping {
            method: Method::Rk4Fixed32,
            steps: 1,
        })
    }

    /// A frame is counted if its bound is at most 1. The largest error of the counted frames is
    /// kept. After an inaccurate frame, or if the candidate is excluded, nothing is recorded.
    #[test]
    fn frames_are_counted_until_one_is_inaccurate() {
        let mut measured = candidate();
        measured.note(0.5, 1.0);
        measured.note(0.25, 0.75);
        assert!(measured.is_accurate() && !measured.has_failed());
        measured.note(0.875, 1.001);
        measured.note(0.75, 0.875);
        assert!(!measured.is_accurate() && measured.has_failed());
        assert_eq!((measured.accurate_frames, measured.error), (2, 0.5));

        let mut excluded = candidate();
        excluded.exclude();
        excluded.note(0.5, 0.5);
        assert!(!excluded.is_accurate() && !excluded.has_failed());
        assert_eq!((excluded.accurate_frames, excluded.error), (0, 0.0));
    }

    /// A horizon is longer if it has more than 1.1 times as many frames.
    #[test]
    fn longer_horizons_are_more_than_a_tenth_longer() {
        let with_frames = |accurate_frames| Candidate {
            accurate_frames,
            ..candidate()
        };
        for (own, other, is_longer) in [
            (12, 10, true),
            (11, 10, false),
            (10, 10, false),
            (1, 0, true),
            (0, 0, false),
        ] {
            let longer = with_frames(own).has_longer_horizon(&with_frames(other));
            assert_eq!(longer, is_longer, "{own}, {other}");
        }
    }

    /// A reference measures better than three finer runs, these better than two, and so on.
    #[test]
    fn references_and_more_finer_runs_measure_better() {
        let best_first = [0, 3, 2, 1].map(|finer_runs| Candidate {
            finer_runs,
            ..candidate()
        });
        for (i, own) in best_first.iter().enumerate() {
            for (j, other) in best_first.iter().enumerate() {
                assert_eq!(own.is_measured_better(other), i < j, "{i}, {j}");
            }
        }
    }

    /// The displacement of bob 2 is the sum of the displacements along both rods. It may be shorter
    /// than either.
    #[test]
    fn distance_is_the_largest_of_bobs_and_relative_position() {
        let from = |a: Directions| distance([2.0, 3.0], &a, &[[0.0; 2]; 2]);
        assert_eq!(from([[1.0, 0.0], [0.0, 1.0]]), 13.0_f32.sqrt());
        assert_eq!(from([[0.5, 0.0], [1.0, 0.0]]), 4.0);
        assert_eq!(from([[3.0, 0.0], [-1.0, 0.0]]), 6.0);
        assert_eq!(from([[0.0, 1.0], [0.0, -2.0]]), 6.0);
        assert!(from([[0.0, f32::NAN], [0.0, 1.0]]).is_nan());
    }
}
