//! One trial: several methods and step counts, run side by side and compared frame by frame.

use super::candidate::{Candidate, distance, greater};
use super::cost::{Costs, Stepping};
use super::problem::{NONE, PERTURBATIONS, Problem};
use super::run::{AnyRun, Directions};
use crate::error::Error;
use crate::methods::{ClosedFormF32, Form, SmallOscillations};
use crate::pendulum::Pendulum;
use crate::table::Method;

/// A motion that is prepared before its first step, and stepped from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Run {
    stepping: Stepping,
    /// Steps since the last frame.
    made: u32,
    /// `None` until it is prepared.
    motion: Option<AnyRun>,
}

impl Run {
    /// Makes steps towards the next frame, as many as are left or as `cost` pays for, one at least. What they cost: 0 if nothing
    /// was left to do.
    #[inline(never)]
    fn advance(&mut self, costs: &Costs, cost: f32) -> f32 {
        let paid = (cost
            / costs.of_frame(Stepping {
                steps: 1,
                ..self.stepping
            })) as u32;
        let left = self.stepping.steps.saturating_sub(self.made);
        let steps = left.min(if paid > 0 { paid } else { 1 });
        if let Some(motion) = &mut self.motion {
            motion.advance(steps);
        }
        self.made += steps;
        costs.of_frame(Stepping {
            steps,
            ..self.stepping
        })
    }

    /// The frame, when nothing is left to do; the next steps lead to the next. NaN if the motion is lost: it may have left its
    /// range where its directions do not show it.
    #[inline(never)]
    fn frame(&mut self) -> Directions {
        self.made = 0;
        let motion = self.motion.as_ref().filter(|motion| motion.check().is_ok());
        motion.map_or([[f32::NAN; 2]; 2], AnyRun::directions)
    }
}

/// How much larger an error may be than the distance to a run in 64 bits, which lasts longer than any in 32.
const BESIDE_64_BITS: f32 = 1.1;

/// How much larger an error may be than the greatest distance to three runs in finer steps.
///
/// Of the error of the step it is no more than 1.7 times that to 5/4 as many steps (order 4), 1.12 times that to 7/4. Roundings are
/// samples of one spread, the run's own and those of the three. In 32 bits of fixed point they have a larger one: all is rounded
/// down. Test `plan_study` holds the bound against the exact motion.
fn beside_finer_steps(method: Method) -> f32 {
    if method == Method::Rk4Fixed32 {
        2.9
    } else {
        2.0
    }
}

/// Steps of the finer runs for each frame: a quarter more, a half, three quarters. Fixed point has another unit of time in each, and
/// with it other constants and roundings: what a word drops of a torque is the same for many steps while a pendulum hardly moves.
/// Where a step is costly, one run is finer at least.
fn steps_beside(Stepping { method, steps }: Stepping) -> [u32; 3] {
    [1, 2, 3].map(|quarters: u32| {
        let least = if method == Method::Extrapolation10Fixed64 {
            quarters / 3
        } else {
            quarters
        };
        let more = (u64::from(steps) * u64::from(quarters) / 4) as u32;
        steps.saturating_add(if more > least { more } else { least })
    })
}

/// Beside a run in 64 bits, a method is tried with once, twice and four times the steps to a frame.
fn tried(stepping: Stepping) -> [Stepping; 3] {
    [1, 2, 4].map(|times| Stepping {
        steps: stepping.steps.saturating_mul(times),
        ..stepping
    })
}

/// Several methods and step counts, run side by side and compared frame by frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Trial {
    /// In 32 bits, the first three candidates and the run in 64 bits that all are compared with. Or a single candidate and three
    /// that it is compared with: in finer steps, their given numbers off by about as much as rounding may make them, each run's
    /// in a way of its own. The last is plain `f32`.
    runs: [Run; 5],
    /// True if the last run is a reference in 64 bits; otherwise the error bounds are rough.
    pub has_reference: bool,
    closed: Option<SmallOscillations<f32>>,
    /// The rods' lengths over the tolerance: so measured, a bob may be off by 1.
    rods: [f32; 2],
    /// The first runs, plain `f32`, the closed form.
    pub candidates: [Candidate; 5],
    /// Whether rounding parts the single candidate from the finer runs.
    by_rounding: bool,
}

impl Trial {
    /// Creates a trial of `stepping`, compared with a run in 64 bits if a `reference` is given.
    pub fn new(stepping: Stepping, problem: &Problem, reference: Option<Stepping>) -> Self {
        let tried = tried(stepping);
        let [second, third, judge] = match reference {
            Some(reference) => [tried[1], tried[2], reference],
            None => steps_beside(stepping).map(|steps| Stepping { steps, ..stepping }),
        };
        let [plain, closed] = [Method::Rk4F32DirectionPlain, Method::ClosedFormF32]
            .map(|method| Stepping { method, ..stepping });
        let mut candidates = [tried[0], tried[1], tried[2], plain, closed].map(Candidate::new);
        candidates[1].failed = reference.is_none();
        candidates[2].failed = reference.is_none();
        candidates[3].failed = stepping.method != Method::Rk4F32Direction;
        let Problem {
            pendulum,
            start,
            rate,
            ..
        } = problem;
        let start = Pendulum::new(pendulum).map(|pendulum| pendulum.to_state(start));
        let closed =
            start.and_then(|start| ClosedFormF32::new(pendulum, &start, 1.0 / f64::from(*rate)));
        Self {
            runs: [stepping, second, third, judge, plain].map(|stepping| Run {
                stepping,
                made: 0,
                motion: None,
            }),
            has_reference: reference.is_some(),
            closed: closed.ok().map(|closed| closed.oscillations),
            rods: [pendulum.l1, pendulum.l2].map(|l| (l / problem.tolerance) as f32),
            candidates,
            by_rounding: false,
        }
    }

    /// Returns the cost of a frame of a trial that is compared with the run `reference` in 64 bits.
    pub fn cost_with_reference(costs: &Costs, stepping: Stepping, reference: Stepping) -> f32 {
        tried(stepping)
            .into_iter()
            .fold(costs.of_frame(reference), |sum, stepping| {
                sum + costs.of_frame(stepping)
            })
    }

    /// The runs that are still needed, by their places.
    fn runs(&mut self) -> impl Iterator<Item = (usize, &mut Run)> {
        let (all, [own, second, third, plain, _]) =
            (!self.has_reference, self.candidates.map(|one| !one.failed));
        let needed = [all || own, all || second, all || third, true, plain];
        self.runs
            .iter_mut()
            .enumerate()
            .zip(needed)
            .filter(|(_, is_needed)| *is_needed)
            .map(|(run, _)| run)
    }

    /// Prepares one motion. Returns false if all motions are prepared.
    ///
    /// If the method refuses the perturbed start, the opposite perturbation is tried, because a start
    /// just within the range of a method may have its neighbour on one side outside.
    #[inline(never)]
    pub fn prepare(&mut self, problem: &Problem) -> Result<bool, Error> {
        let has_reference = self.has_reference;
        let Some((place, run)) = self.runs().find(|(_, run)| run.motion.is_none()) else {
            return Ok(false);
        };
        let by = PERTURBATIONS
            .get(place.wrapping_sub(1))
            .filter(|_| !has_reference)
            .copied()
            .unwrap_or(NONE);
        let Stepping { method, steps } = run.stepping;
        let start = Pendulum::new(&problem.pendulum)?.to_state(&problem.start);
        let prepared = |by| {
            let given = problem.perturbed(&start, by, method);
            AnyRun::new(method, &given, f64::from(problem.rate) * f64::from(steps))
        };
        run.motion = Some(prepared(by).or_else(|_| prepared(by.map(|by| -by)))?);
        Ok(true)
    }

    /// Makes steps of one motion towards the next frame, as many as `cost` pays for and at least one.
    ///
    /// Returns their cost; 0 if every motion has reached the frame.
    pub fn advance(&mut self, costs: &Costs, cost: f32) -> f32 {
        self.runs()
            .map(|(_, run)| run.advance(costs, cost))
            .find(|&spent| spent > 0.0)
            .unwrap_or(0.0)
    }

    /// Compares the frames at time `t`, s, when all steps towards them are made. A method fails where it may be off by more
    /// than the tolerance.
    pub fn compare(&mut self, t: f64) {
        let [own, second, third, last, plain] = self.runs.each_mut().map(Run::frame);
        let (judge, margin, error, bound) = if self.has_reference {
            (last, BESIDE_64_BITS, 0.0, 0.0)
        } else {
            let others = [second, third, last].map(|other| distance(self.rods, &own, &other));
            let greatest = others.into_iter().fold(0.0, greater);
            self.by_rounding = others.into_iter().any(|other| 2.0 * other < greatest);
            (
                own,
                1.0,
                greatest,
                beside_finer_steps(self.candidates[0].stepping.method) * greatest,
            )
        };
        let closed = self
            .closed
            .map_or([[f32::NAN; 2]; 2], |motion| motion.directions(t));
        let shown = [own, second, third, plain, closed];
        for (candidate, shown) in self
            .candidates
            .iter_mut()
            .zip(shown)
            .filter(|(candidate, _)| !candidate.failed)
        {
            let beside = distance(self.rods, &shown, &judge);
            candidate.note(beside + error, margin * beside + bound);
        }
    }

    /// Excludes the candidates that are not `wanted`.
    pub fn retain(&mut self, wanted: impl Fn(&Candidate) -> bool) {
        self.candidates
            .iter_mut()
            .filter(|candidate| !wanted(candidate))
            .for_each(|candidate| candidate.failed = true);
    }

    /// Returns the factor by which to multiply the step count in the next trial, or `None` if finer
    /// steps do not help because rounding is the larger error.
    pub fn refinement(&self) -> Option<u32> {
        let [_, second, third, ..] = &self.candidates;
        let (helps, times) = if self.has_reference {
            (third.has_longer_horizon(second), 8)
        } else {
            (!self.by_rounding, 2)
        };
        helps.then_some(times)
    }

    /// Returns the cost of a frame of all runs that are still needed.
    pub fn frame_cost(&mut self, costs: &Costs) -> f32 {
        let [.., closed] = &self.candidates;
        let closed = if closed.failed {
            0.0
        } else {
            costs.of_frame(closed.stepping)
        };
        self.runs()
            .fold(closed, |sum, (_, run)| sum + costs.of_frame(run.stepping))
    }
}
