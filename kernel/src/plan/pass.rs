//! Looking ahead with one step size: how wrong each way is, frame by frame.

use super::cost::{Costs, Method};
use super::problem::{Problem, Twin};
use super::run::{Directions, Run, distance};
use super::shadowed_run::{ErrorEstimate, ShadowedRun};
use crate::error::Error;
use crate::form::{AngleForm, DirectionForm, DirectionForm8, Plain};
use crate::modes::Modes;
use crate::small_oscillations::SmallOscillations;
use crate::state::State;

/// How a way has fared so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// The way.
    pub way: Method,
    /// Steps to a frame.
    pub steps: u32,
    /// Frames it was right in, from the start on.
    pub right: u32,
    /// The largest error measured in them, pixels.
    pub error: f32,
    /// Whether it has been wrong.
    pub failed: bool,
    /// Whether rounding made its bound when it failed: finer steps do not help.
    pub by_rounding: bool,
}

impl Candidate {
    /// At the start.
    pub fn new(way: Method, steps: u32) -> Self {
        Self { way, steps, right: 0, error: 0.0, failed: false, by_rounding: false }
    }

    /// Takes note of a frame `beside` pixels from the shadowed one, which itself is in `doubt`. NaN is wrong.
    fn note(&mut self, beside: f32, doubt: ErrorEstimate, limit: f32) {
        if self.failed {
            return;
        }
        if beside + doubt.bound() <= limit {
            let error = beside + doubt.error();
            self.error = if error > self.error { error } else { self.error };
            self.right += 1;
        } else {
            self.failed = true;
            self.by_rounding = doubt.is_by_rounding();
        }
    }
}

/// All ways in `f32` with one step size. The compensated direction form is the best of them and judges the others.
#[derive(Clone, Copy, Debug)]
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
        let rounded = problem.rounded::<f32>(start, Twin::None);
        let (parameters, _) = &rounded;
        let motion = problem.start.cast();
        let linear = Modes::new(parameters).ok().map(|modes| SmallOscillations::new(modes, &motion));
        let ways = [Method::Direction, Method::ClosedForm, Method::DirectionPlain, Method::Angle];
        Self {
            shadowed: ShadowedRun::from_state(problem, start, steps),
            plain: Run::new(&rounded, problem.rate, steps),
            angle: Run::new(&rounded, problem.rate, steps),
            linear,
            rods: problem.rods(),
            candidates: ways.map(|way| Candidate::new(way, steps)),
        }
    }

    /// As [`Pass::advance`].
    fn advance(&mut self, costs: &Costs, cycles: f32) -> Result<bool, Error> {
        let [_, _, plain, angle] = &self.candidates;
        let most = |way: Method| steps_for(costs, way, cycles);
        Ok(self.shadowed.advance(most(Method::Direction))?
            || !plain.failed && self.plain.advance(most(Method::DirectionPlain))?
            || !angle.failed && self.angle.advance(most(Method::Angle))?)
    }

    /// As [`Pass::compare`].
    fn compare(&mut self, t: f64, limit: f32) {
        let (frame, doubt) = self.shadowed.frame();
        let beside = |other: Directions| distance(self.rods, &frame, &other);
        let [own, closed, plain, angle] = &mut self.candidates;
        own.note(0.0, doubt, limit);
        if !closed.failed {
            closed.note(self.linear.map_or(f32::INFINITY, |motion| beside(motion.directions(t as f32))), doubt, limit);
        }
        if !plain.failed {
            plain.note(beside(self.plain.frame()), doubt, limit);
        }
        if !angle.failed {
            angle.note(beside(self.angle.frame()), doubt, limit);
        }
    }

    fn cost(&self, costs: &Costs) -> f32 {
        let [own, ..] = self.candidates;
        let shadowed = costs.of_frame(own.way, own.steps) * ShadowedRun::<f32, DirectionForm<f32>>::RUNS;
        let others = self.candidates.iter().filter(|candidate| candidate.way != own.way && !candidate.failed);
        others.fold(shadowed, |sum, candidate| sum + costs.of_frame(candidate.way, candidate.steps))
    }
}

/// The way in `f64` with one step size.
#[derive(Clone, Copy, Debug)]
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
#[derive(Clone, Copy, Debug)]
pub(super) enum Pass {
    /// In `f32`.
    Single(Single),
    /// In `f64`.
    Double(Double),
}

impl Pass {
    /// Makes steps of one motion towards the next frame, as many as `cycles` pay for and one at least, or prepares
    /// them. `false` if there is nothing left to do.
    pub fn advance(&mut self, costs: &Costs, cycles: f32) -> Result<bool, Error> {
        match self {
            Pass::Single(look) => look.advance(costs, cycles),
            Pass::Double(look) => look.shadowed.advance(steps_for(costs, look.candidate.way, cycles)),
        }
    }

    /// Compares the frames at time `t`, s, when all steps towards them are made. A way fails where it may be more than
    /// `limit` pixels off.
    pub fn compare(&mut self, t: f64, limit: f32) {
        match self {
            Pass::Single(look) => look.compare(t, limit),
            Pass::Double(look) => {
                let (_, doubt) = look.shadowed.frame();
                look.candidate.note(0.0, doubt, limit);
            }
        }
    }

    /// Looks at `way` alone, beside what judges it.
    pub fn only(&mut self, way: Method) {
        if let Pass::Single(look) = self {
            look.candidates
                .iter_mut()
                .filter(|candidate| candidate.way != way)
                .for_each(|candidate| candidate.failed = true);
        }
    }

    /// How the ways have fared.
    pub fn candidates(&self) -> &[Candidate] {
        match self {
            Pass::Single(look) => &look.candidates,
            Pass::Double(look) => core::slice::from_ref(&look.candidate),
        }
    }

    /// How the way has fared that judges the others.
    pub fn judge(&self) -> &Candidate {
        match self {
            Pass::Single(Single { candidates: [own, ..], .. }) => own,
            Pass::Double(look) => &look.candidate,
        }
    }

    /// Cycles of the most expensive of the steps that are made.
    pub fn dearest_step(&self, costs: &Costs) -> f32 {
        let steps =
            self.candidates().iter().filter(|candidate| candidate.way != Method::ClosedForm && !candidate.failed);
        let judge = costs.of_frame(self.judge().way, 1);
        steps.map(|candidate| costs.of_frame(candidate.way, 1)).fold(judge, f32::max)
    }

    /// Cycles that the next frame takes.
    pub fn cost(&self, costs: &Costs) -> f32 {
        match self {
            Pass::Single(look) => look.cost(costs),
            Pass::Double(look) => {
                costs.of_frame(look.candidate.way, look.candidate.steps) * ShadowedRun::<f64, DirectionForm8<f64>>::RUNS
            }
        }
    }
}

/// How many steps of `way` these `cycles` pay for, one at least.
fn steps_for(costs: &Costs, way: Method, cycles: f32) -> u32 {
    let steps = (cycles / costs.of_frame(way, 1)) as u32;
    if steps > 0 { steps } else { 1 }
}
