//! A run that knows how wrong it is.

use super::error::PlanError;
use super::problem::{Perturbation, Problem};
use super::run::{Directions, Run, distance, greater};
use crate::error::Error;
use crate::pendulum::{Pendulum, State};
use crate::table::Method;

/// How much larger an error may be than the distances: that to the finer steps, and the larger of those to other roundings.
///
/// To the finer steps the error of the step is 16/15 of the distance (order 4), 5/4 in fixed point, or less than 10/9 (order 10)
/// where the steps resolve the motion. Roundings are samples of the same spread, those of the run itself, of the finer steps and of the two
/// others. Test `plan_study` holds the sum against the exact motion.
pub const MARGINS: [f32; 2] = [1.25, 2.0];

/// How far the runs are apart that tell how wrong one of them is, over the tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorEstimate {
    /// The one with finer steps, which has other roundings, too.
    pub step: f32,
    /// The farther of those with other roundings.
    pub rounding: f32,
}

impl ErrorEstimate {
    /// What the error is hardly ever more than, over the tolerance.
    #[must_use]
    pub fn bound(self) -> f32 {
        let [step, rounding] = MARGINS;
        step * self.step + rounding * self.rounding
    }

    /// What the error is about, over the tolerance.
    #[must_use]
    pub fn error(self) -> f32 {
        greater(self.step, self.rounding)
    }

    /// Whether rounding is what parts the runs: finer steps do not help. All three have roundings of their own, so where
    /// nothing else is wrong their distances are alike.
    #[must_use]
    pub fn is_by_rounding(self) -> bool {
        2.0 * self.rounding >= self.step
    }
}

/// A motion beside one with finer steps, for the error of the step, and two with the same, for the error of rounding. The given
/// numbers of all three are off by about as much as rounding may make them, each run's in a way of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowedRun {
    method: Method,
    own: Run,
    finer: Run,
    perturbed: [Run; 2],
    rods: [f32; 2],
}

/// Steps of the finer run for each frame. By order 4 twice as many leave a sixteenth of the error, half as many again a fifth; by
/// a high order a quarter more leave a tenth. Fixed point has another unit of time then, and with it other constants and
/// roundings: what a word drops of a torque is the same for many steps while a pendulum hardly moves.
fn finer(method: Method, steps: u32) -> u32 {
    steps.saturating_add(match method {
        Method::Extrapolation10Fixed64 => steps / 4 + 1,
        Method::Rk4Fixed32 if steps > 1 => steps / 2,
        Method::Rk4Fixed32 => 2,
        _ => steps,
    })
}

/// What the distance to the finer run counts: in fixed point it is the only one with other constants.
fn weight(method: Method) -> f32 {
    match method {
        Method::Extrapolation10Fixed64 => 3.0,
        Method::Rk4Fixed32 => 3.0,
        _ => 1.0,
    }
}

/// Steps made by all the runs for each frame.
pub(super) fn steps_of_all(method: Method, steps: u32) -> u32 {
    finer(method, steps).saturating_add(steps.saturating_mul(3))
}

impl ShadowedRun {
    /// By `method` with `steps` steps for each frame.
    ///
    /// Refuses a problem without a tolerance, a duration or a rate, and a pendulum that the kernel refuses.
    pub fn new(method: Method, problem: &Problem, steps: u32) -> Result<Self, PlanError> {
        problem.check()?;
        Ok(Self::from_state(method, problem, &Pendulum::new(&problem.pendulum)?.to_state(&problem.start), steps))
    }

    /// From `start`, with `steps` steps for each frame.
    #[inline(never)]
    pub(super) fn from_state(method: Method, problem: &Problem, start: &State<f64>, steps: u32) -> Self {
        let run = |perturbation: Perturbation, steps| {
            // What a method takes ends somewhere: a run just within may have its neighbour on one side beyond.
            let given = [perturbation, perturbation.mirrored()].map(|by| problem.perturbed(start, by, method));
            Run::new(method, given, problem.rate, steps)
        };
        let [other, perturbed @ ..] = Perturbation::ALL;
        Self {
            method,
            own: run(Perturbation::NONE, steps),
            finer: run(other, finer(method, steps)),
            perturbed: perturbed.map(|perturbation| run(perturbation, steps)),
            rods: problem.rods(),
        }
    }

    fn runs(&mut self) -> impl Iterator<Item = &mut Run> {
        [&mut self.own, &mut self.finer].into_iter().chain(&mut self.perturbed)
    }

    /// Prepares one of the runs; whether there was one to prepare.
    pub(super) fn prepare(&mut self) -> Result<bool, Error> {
        self.runs().map(Run::prepare).find(|prepared| *prepared != Ok(false)).unwrap_or(Ok(false))
    }

    /// As [`Run::advance`], one of the runs.
    pub(super) fn advance(&mut self, most: u32) -> u32 {
        self.runs().map(|run| run.advance(most)).find(|&steps| steps > 0).unwrap_or(0)
    }

    /// The frame that all steps have led to, and how wrong it is.
    pub(super) fn frame(&mut self) -> (Directions, ErrorEstimate) {
        let frame = self.own.frame();
        let apart = |other: &mut Run| distance(self.rods, &frame, &other.frame());
        let step = weight(self.method) * apart(&mut self.finer);
        let rounding = self.perturbed.iter_mut().map(apart).fold(0.0, greater);
        (frame, ErrorEstimate { step, rounding })
    }

    /// The next frame, and how wrong it is. Refuses a pendulum out of the range of the arithmetic.
    pub fn next_frame(&mut self) -> Result<(Directions, ErrorEstimate), Error> {
        while self.prepare()? {}
        while self.advance(u32::MAX) > 0 {}
        Ok(self.frame())
    }
}
