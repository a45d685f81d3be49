//! One step size tried: how wrong each method is, frame by frame.

use super::cost::Costs;
use super::problem::Problem;
use super::run::{Directions, Run, distance};
use super::shadowed_run::{ErrorEstimate, ShadowedRun, steps_of_all};
use super::way::Way;
use crate::error::Error;
use crate::methods::{DirectionF32Plain, Stepper};
use crate::pendulum::State;
use crate::small::{Modes, SmallOscillations};
use crate::table::Method;

/// A bob may be off by this much where the tolerance is the unit.
const TOLERATED: f32 = 1.0;

/// How a method has fared so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    /// The method.
    pub method: Method,
    /// Steps to a frame.
    pub steps: u32,
    /// Frames it was right in, from the start on.
    pub right: u32,
    /// The largest error measured in them, over the tolerance.
    pub error: f32,
    /// Whether it has been wrong.
    pub failed: bool,
    /// Whether rounding made its bound when it failed: finer steps do not help.
    pub by_rounding: bool,
}

impl Candidate {
    /// At the start.
    pub fn new(method: Method, steps: u32) -> Self {
        Self { method, steps, right: 0, error: 0.0, failed: false, by_rounding: false }
    }

    /// In how many frames it shows `way` to be right; one that has the longest horizon of all is so wherever any is.
    #[inline(never)] // one copy
    pub fn right_of(&self, way: Way, has_longest_horizon: bool) -> u32 {
        let is_same = self.steps == way.steps || way.method == Method::ClosedFormF32;
        let is_shown = has_longest_horizon || self.method == way.method && is_same;
        if is_shown { self.right } else { 0 }
    }

    /// Takes note of a frame that is `beside` off the shadowed one, whose own error is estimated. NaN is wrong.
    #[inline(never)] // one copy
    fn note(&mut self, beside: f32, estimate: ErrorEstimate) {
        if self.failed {
            return;
        }
        if beside + estimate.bound() <= TOLERATED {
            let error = beside + estimate.error();
            self.error = if error > self.error { error } else { self.error };
            self.right += 1;
        } else {
            self.failed = true;
            self.by_rounding = estimate.is_by_rounding();
        }
    }
}

/// One step size tried: a shadowed run, and what is compared with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pass {
    shadowed: ShadowedRun,
    /// Plain `f32`, which shows beside compensated sums what its roundings do.
    plain: Run<Stepper<DirectionF32Plain>>,
    closed: Option<SmallOscillations<f32>>,
    rods: [f32; 2],
    /// The shadowed method, the closed form, and plain `f32`.
    candidates: [Candidate; 3],
}

impl Pass {
    /// From `start`, with `steps` steps to a frame: `method` is shadowed, or compensated `f32` if it has no steps of its own.
    pub fn new(method: Method, problem: &Problem, start: &State<f64>, steps: u32) -> Self {
        let method = if matches!(method, Method::Rk4Fixed32 | Method::Extrapolation10Fixed64) {
            method
        } else {
            Method::Rk4F32Direction
        };
        let given = (problem.pendulum, *start);
        let methods = [method, Method::ClosedFormF32, Method::Rk4F32DirectionPlain];
        let mut pass = Self {
            shadowed: ShadowedRun::from_state(method, problem, start, steps),
            plain: Run::new(Method::Rk4F32DirectionPlain, [given; 2], problem.rate, steps),
            closed: Modes::new(&problem.pendulum)
                .ok()
                .map(|modes| SmallOscillations::new(modes, &problem.start.cast())),
            rods: problem.rods(),
            candidates: methods.map(|method| Candidate::new(method, steps)),
        };
        let [own, _, plain] = &mut pass.candidates;
        plain.failed = own.method != Method::Rk4F32Direction;
        pass
    }

    /// Prepares one motion; whether there was one to prepare.
    pub fn prepare(&mut self) -> Result<bool, Error> {
        let [.., plain] = &self.candidates;
        Ok(self.shadowed.prepare()? || !plain.failed && self.plain.prepare()?)
    }

    /// Makes steps of one motion towards the next frame, as many as `cost` pays for and one at least. What they cost; 0 if
    /// there is nothing left to do.
    pub fn advance(&mut self, costs: &Costs, cost: f32) -> f32 {
        let [own, _, plain] = &self.candidates;
        let most = |method: Method| steps_for(costs, method, cost);
        let steps = self.shadowed.advance(most(own.method));
        if steps > 0 || plain.failed {
            return costs.of_frame(own.method, steps);
        }
        let steps = self.plain.advance(most(plain.method));
        costs.of_frame(plain.method, steps)
    }

    /// Compares the frames at time `t`, s, when all steps towards them are made. A method fails where it may be off by more
    /// than the tolerance.
    pub fn compare(&mut self, t: f64) {
        let (frame, estimate) = self.shadowed.frame();
        let beside = |other: Directions| distance(self.rods, &frame, &other);
        let [own, closed, plain] = &mut self.candidates;
        own.note(0.0, estimate);
        if !closed.failed {
            let beside = self.closed.map_or(f32::INFINITY, |motion| beside(motion.directions(t)));
            closed.note(beside, estimate);
        }
        if !plain.failed {
            plain.note(beside(self.plain.frame()), estimate);
        }
    }

    /// Looks at `method` alone, beside the shadowed run.
    pub fn only(&mut self, method: Method) {
        let others = self.candidates.iter_mut().filter(|candidate| candidate.method != method);
        others.for_each(|candidate| candidate.failed = true);
    }

    /// How the methods have fared.
    pub fn candidates(&self) -> &[Candidate; 3] {
        &self.candidates
    }

    /// How the method of the shadowed run has fared.
    pub fn shadowed(&self) -> &Candidate {
        let [own, ..] = &self.candidates;
        own
    }

    /// What the next frame costs.
    pub fn cost(&self, costs: &Costs) -> f32 {
        let [own, others @ ..] = &self.candidates;
        let shadowed = costs.of_frame(own.method, steps_of_all(own.method, own.steps));
        let others = others.iter().filter(|candidate| !candidate.failed);
        others.fold(shadowed, |sum, candidate| sum + costs.of_frame(candidate.method, candidate.steps))
    }
}

/// How many steps of `method` this `cost` pays for, one at least.
fn steps_for(costs: &Costs, method: Method, cost: f32) -> u32 {
    let steps = (cost / costs.of_frame(method, 1)) as u32;
    if steps > 0 { steps } else { 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_right_in_one_way_says_nothing_of_another() {
        let candidate = Candidate { right: 7, ..Candidate::new(Method::Rk4F32Direction, 4) };
        let right = |method, steps, has_longest_horizon| candidate.right_of(Way { method, steps }, has_longest_horizon);
        assert_eq!(right(Method::Rk4F32Direction, 4, false), 7);
        assert_eq!(right(Method::Rk4F32Direction, 2, false), 0);
        assert_eq!(right(Method::Rk4F32DirectionPlain, 4, false), 0);
        assert_eq!(right(Method::Extrapolation10Fixed64, 3, true), 7);
        let closed = Candidate { right: 5, ..Candidate::new(Method::ClosedFormF32, 1) };
        assert_eq!(closed.right_of(Way { method: Method::ClosedFormF32, steps: 0 }, false), 5);
        assert_eq!(closed.right_of(Way { method: Method::Rk4F32Direction, steps: 1 }, false), 0);
    }

    #[test]
    fn a_cost_pays_for_whole_steps_and_for_one_at_least() {
        let costs = Costs {
            closed_form: 10.0,
            direction_plain: 100.0,
            direction: 150.0,
            fixed32: 120.0,
            fixed64: 900.0,
            preparation: 1000.0,
        };
        let steps = |cost| steps_for(&costs, Method::Rk4F32DirectionPlain, cost);
        assert_eq!([50.0, 100.0, 399.0, 400.0].map(steps), [1, 1, 3, 4]);
    }
}
