//! Looking ahead with one step size: how wrong each method is, frame by frame.

use super::cost::{Costs, Method};
use super::problem::{Perturbation, Problem};
use super::run::{Directions, Run, distance};
use super::shadowed_run::{ErrorEstimate, ShadowedRun};
use crate::error::Error;
use crate::form::{AngleForm, DirectionForm, DirectionForm8, Plain};
use crate::modes::Modes;
use crate::small_oscillations::SmallOscillations;
use crate::state::State;

/// A bob may be off by this much where the tolerance is the unit.
const TOLERATED: f32 = 1.0;

/// How a method has fared so far.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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

    /// Takes note of a frame that is `beside` off the shadowed one, whose own error is estimated. NaN is wrong.
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

/// All methods in `f32` with one step size. The compensated direction form is the best of them: its run is shadowed, and the
/// others are compared with it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Single {
    shadowed: ShadowedRun<f32, DirectionForm<f32>>,
    plain: Run<f32, DirectionForm<f32, Plain>>,
    angle: Run<f32, AngleForm<f32>>,
    linear: Option<SmallOscillations<f32>>,
    rods: [f32; 2],
    candidates: [Candidate; 4],
}

impl Single {
    /// From `start`, with `steps` steps to a frame.
    pub fn new(problem: &Problem, start: &State<f64>, steps: u32) -> Self {
        let rounded = problem.rounded::<f32>(start, Perturbation::None);
        let (parameters, _) = &rounded;
        let motion = problem.start.cast();
        let linear = Modes::new(parameters).ok().map(|modes| SmallOscillations::new(modes, &motion));
        let methods = [Method::Direction, Method::ClosedForm, Method::DirectionPlain, Method::Angle];
        Self {
            shadowed: ShadowedRun::from_state(problem, start, steps),
            plain: Run::new(&rounded, problem.rate, steps),
            angle: Run::new(&rounded, problem.rate, steps),
            linear,
            rods: problem.rods(),
            candidates: methods.map(|method| Candidate::new(method, steps)),
        }
    }

    /// As [`Pass::advance`].
    fn advance(&mut self, costs: &Costs, cost: f32) -> Result<bool, Error> {
        let [_, _, plain, angle] = &self.candidates;
        let most = |method: Method| steps_for(costs, method, cost);
        Ok(self.shadowed.advance(most(Method::Direction))?
            || !plain.failed && self.plain.advance(most(Method::DirectionPlain))?
            || !angle.failed && self.angle.advance(most(Method::Angle))?)
    }

    /// As [`Pass::compare`].
    fn compare(&mut self, t: f64) {
        let (frame, estimate) = self.shadowed.frame();
        let beside = |other: Directions| distance(self.rods, &frame, &other);
        let [own, closed, plain, angle] = &mut self.candidates;
        own.note(0.0, estimate);
        if !closed.failed {
            closed.note(self.linear.map_or(f32::INFINITY, |motion| beside(motion.directions(t as f32))), estimate);
        }
        if !plain.failed {
            plain.note(beside(self.plain.frame()), estimate);
        }
        if !angle.failed {
            angle.note(beside(self.angle.frame()), estimate);
        }
    }

    fn cost(&self, costs: &Costs) -> f32 {
        let [own, ..] = self.candidates;
        let shadowed = costs.of_frame(own.method, own.steps) * ShadowedRun::<f32, DirectionForm<f32>>::RUNS;
        let others = self.candidates.iter().filter(|candidate| candidate.method != own.method && !candidate.failed);
        others.fold(shadowed, |sum, candidate| sum + costs.of_frame(candidate.method, candidate.steps))
    }
}

/// The method in `f64` with one step size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Double {
    shadowed: ShadowedRun<f64, DirectionForm8<f64>>,
    candidate: Candidate,
}

impl Double {
    /// From `start`, with `steps` steps to a frame.
    pub fn new(problem: &Problem, start: &State<f64>, steps: u32) -> Self {
        Self {
            shadowed: ShadowedRun::from_state(problem, start, steps),
            candidate: Candidate::new(Method::Direction8, steps),
        }
    }
}

/// Looking ahead in one precision with one step size.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Pass {
    /// In `f32`.
    Single(Single),
    /// In `f64`.
    Double(Double),
}

impl Pass {
    /// Makes steps of one motion towards the next frame, as many as `cost` pays for and one at least, or prepares
    /// them. `false` if there is nothing left to do.
    pub fn advance(&mut self, costs: &Costs, cost: f32) -> Result<bool, Error> {
        match self {
            Pass::Single(single) => single.advance(costs, cost),
            Pass::Double(double) => double.shadowed.advance(steps_for(costs, double.candidate.method, cost)),
        }
    }

    /// Compares the frames at time `t`, s, when all steps towards them are made. A method fails where it may be off by more
    /// than the tolerance.
    pub fn compare(&mut self, t: f64) {
        match self {
            Pass::Single(single) => single.compare(t),
            Pass::Double(double) => {
                let (_, estimate) = double.shadowed.frame();
                double.candidate.note(0.0, estimate);
            }
        }
    }

    /// Looks at `method` alone, beside the shadowed run.
    pub fn only(&mut self, method: Method) {
        if let Pass::Single(single) = self {
            single
                .candidates
                .iter_mut()
                .filter(|candidate| candidate.method != method)
                .for_each(|candidate| candidate.failed = true);
        }
    }

    /// How the methods have fared.
    pub fn candidates(&self) -> &[Candidate] {
        match self {
            Pass::Single(single) => &single.candidates,
            Pass::Double(double) => core::slice::from_ref(&double.candidate),
        }
    }

    /// How the method of the shadowed run has fared.
    pub fn shadowed(&self) -> &Candidate {
        match self {
            Pass::Single(Single { candidates: [own, ..], .. }) => own,
            Pass::Double(double) => &double.candidate,
        }
    }

    /// What the most expensive of the steps costs that are made.
    pub fn most_expensive_step(&self, costs: &Costs) -> f32 {
        let steps =
            self.candidates().iter().filter(|candidate| candidate.method != Method::ClosedForm && !candidate.failed);
        let shadowed = costs.of_frame(self.shadowed().method, 1);
        steps.map(|candidate| costs.of_frame(candidate.method, 1)).fold(shadowed, f32::max)
    }

    /// What the next frame costs.
    pub fn cost(&self, costs: &Costs) -> f32 {
        match self {
            Pass::Single(single) => single.cost(costs),
            Pass::Double(double) => {
                costs.of_frame(double.candidate.method, double.candidate.steps)
                    * ShadowedRun::<f64, DirectionForm8<f64>>::RUNS
            }
        }
    }
}

/// How many steps of `method` this `cost` pays for, one at least.
fn steps_for(costs: &Costs, method: Method, cost: f32) -> u32 {
    let steps = (cost / costs.of_frame(method, 1)) as u32;
    if steps > 0 { steps } else { 1 }
}
