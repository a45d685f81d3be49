//! A method that is tried.

use super::cost::{Costs, Way};
use crate::table::Method;

/// A bob may be off by this much where the tolerance is the unit.
const TOLERATED: f32 = 1.0;

/// A method must be right for this much longer than another to be worth its cost.
const WORTH: f64 = 1.1;

/// How a method has fared so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub way: Way,
    /// Frames it was right in, from the start on.
    pub right: u32,
    /// The largest error measured in them, over the tolerance.
    pub error: f32,
    /// Whether it has been wrong, or is not looked at.
    pub failed: bool,
}

impl Candidate {
    pub fn new(way: Way) -> Self {
        Self { way, right: 0, error: 0.0, failed: false }
    }

    pub fn cost(&self, costs: &Costs) -> f32 {
        costs.of_frame(self.way.method, self.way.steps)
    }

    /// Whether it is right for so much longer than `other` that it is worth more.
    pub fn outlasts(&self, other: &Self) -> bool {
        f64::from(self.right) > WORTH * f64::from(other.right)
    }

    /// In how many frames it shows `way` to be right; one that has the longest horizon of all is so wherever any is.
    #[inline(never)] // one copy
    pub fn right_of(&self, way: Way, has_longest_horizon: bool) -> u32 {
        let is_same = self.way.steps == way.steps || way.method == Method::ClosedFormF32;
        let is_shown = has_longest_horizon || self.way.method == way.method && is_same;
        if is_shown { self.right } else { 0 }
    }

    /// Takes note of a frame with an error of about `error`, and hardly ever more than `bound`. NaN is wrong.
    #[inline(never)] // one copy
    pub fn note(&mut self, error: f32, bound: f32) {
        if bound <= TOLERATED {
            self.error = if error > self.error { error } else { self.error };
            self.right += 1;
        } else {
            self.failed = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_right_in_one_way_says_nothing_of_another() {
        let right = |of: (Method, u32), method, steps, has_longest_horizon| {
            let candidate = Candidate { right: 7, ..Candidate::new(Way { method: of.0, steps: of.1 }) };
            candidate.right_of(Way { method, steps }, has_longest_horizon)
        };
        let direction = (Method::Rk4F32Direction, 4);
        assert_eq!(right(direction, Method::Rk4F32Direction, 4, false), 7);
        assert_eq!(right(direction, Method::Rk4F32Direction, 2, false), 0);
        assert_eq!(right(direction, Method::Rk4F32DirectionPlain, 4, false), 0);
        assert_eq!(right(direction, Method::Extrapolation10Fixed64, 3, true), 7);
        assert_eq!(right((Method::ClosedFormF32, 1), Method::ClosedFormF32, 0, false), 7);
        assert_eq!(right((Method::ClosedFormF32, 1), Method::Rk4F32Direction, 1, false), 0);
    }
}
