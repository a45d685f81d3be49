//! One trial: several methods and step counts, run side by side and compared frame by frame.
//!
//! # The errors of a trial with a reference
//!
//! The reference is a pair of runs in 64 bits: a *fine* one, and a *coarse* one that makes about three
//! quarters of its steps. Both have the same order p = 10, so that the truncation error of the coarse
//! run is (fine/coarse)^p times that of the fine one, and the distance between the two measures it.
//!
//! The rounding errors of both are too much alike to be measured so. How large they may be is known
//! where they arise; by how much they have grown since is measured by *shadows* ([`Shadows`]).
//!
//! | error of | is at most |
//! |---|---|
//! | the fine run | the share of the distance to the coarse run that truncation explains, and grown roundings |
//! | the coarse run | the distance to the fine run, and the error of that |
//! | a candidate in 32 bits, the closed form | the distance to the fine run, and the error of that |
//!
//! # The errors of a trial without one
//!
//! If planning cannot pay for a reference, a candidate in 32 bits is compared with three runs by the
//! same method in finer steps, the given numbers of each perturbed by about their rounding error.

use super::candidate::{Candidate, distance, greater};
use super::cost::{Costs, Pair, Stepping};
use super::problem::{NONE, PERTURBATIONS, Problem};
use super::run::{Directions, DoubleRun, SingleRun};
use super::shadow::Shadows;
use crate::error::Error;
use crate::methods::{ClosedFormF32, Form, SmallOscillations};
use crate::pendulum::{Pendulum, State};
use crate::table::Method;

/// A motion that a trial makes steps of.
pub(super) trait Motion {
    fn advance(&mut self, steps: u32);
    fn check(&self) -> Result<(), Error>;
    fn directions(&self) -> Directions;
}

impl Motion for SingleRun {
    fn advance(&mut self, steps: u32) {
        SingleRun::advance(self, steps);
    }
    fn check(&self) -> Result<(), Error> {
        SingleRun::check(self)
    }
    fn directions(&self) -> Directions {
        SingleRun::directions(self)
    }
}

impl Motion for DoubleRun {
    fn advance(&mut self, steps: u32) {
        Form::advance(self, steps);
    }
    fn check(&self) -> Result<(), Error> {
        Form::check(self)
    }
    fn directions(&self) -> Directions {
        Form::directions(self)
    }
}

/// A motion that is prepared before its first step, and stepped from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run<M> {
    pub stepping: Stepping,
    /// The number of steps since the last frame.
    made: u32,
    /// `None` until it is prepared.
    pub motion: Option<M>,
}

impl<M: Motion> Run<M> {
    pub fn new(stepping: Stepping) -> Self {
        Self {
            stepping,
            made: 0,
            motion: None,
        }
    }

    /// Makes steps towards the next frame: all that are left, or as many as `cost` pays for and at
    /// least one. Returns their cost; 0 if no step was left.
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

    /// Returns the frame when all steps towards it are made, and begins the next one.
    ///
    /// The frame is NaN if the motion has diverged, which its directions need not show.
    #[inline(never)]
    pub fn frame(&mut self) -> Directions {
        self.made = 0;
        let motion = self.motion.as_ref().filter(|motion| motion.check().is_ok());
        motion.map_or([[f32::NAN; 2]; 2], Motion::directions)
    }
}

/// The margin on the distance to the fine run. Its own error is counted apart.
const BESIDE_REFERENCE: f32 = 1.1;

/// The margin on the greatest distance to three runs in finer steps.
///
/// The truncation error is at most 1.7 times the distance to a run with 5/4 of the steps (order 4),
/// and 1.12 times that to one with 7/4. Roundings are samples of one spread, the run's own and those
/// of the three. Test `plan_study` holds the bound against the exact motion.
const BESIDE_FINER_STEPS: f32 = 2.9;

/// Returns the steps of the finer runs for each frame: a quarter more, a half, three quarters.
///
/// Fixed point has another unit of time in each, and with it other constants and roundings: what a
/// word drops of a torque is the same for many steps while a pendulum hardly moves.
fn steps_beside(Stepping { method, steps }: Stepping) -> [Stepping; 3] {
    [1, 2, 3].map(|quarters: u32| {
        let more = (u64::from(steps) * u64::from(quarters) / 4) as u32;
        let steps = steps.saturating_add(if more > quarters { more } else { quarters });
        Stepping { method, steps }
    })
}

/// Returns the candidates of a trial with a reference: once, twice and four times the steps.
fn tried(stepping: Stepping) -> [Stepping; 3] {
    [1, 2, 4].map(|times| Stepping {
        steps: stepping.steps.saturating_mul(times),
        ..stepping
    })
}

/// The places of candidates and runs.
const THIRD: usize = 2;
const PLAIN: usize = 3;
const CLOSED: usize = 4;
const COARSE: usize = 5;
const FINE: usize = 6;

/// Several methods and step counts, run side by side and compared frame by frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Trial {
    /// With a reference, the first three candidates and plain `f32`. Otherwise a single candidate, two
    /// finer runs, plain `f32`, and the third finer run.
    single: [Run<SingleRun>; 5],
    /// The coarse and the fine run of the reference.
    double: [Run<DoubleRun>; 2],
    /// The reference: the coarse and the fine run. `None` if there is none; then error bounds are
    /// rough.
    pub reference: Option<Pair>,
    shadows: Shadows,
    /// True if the trial began with a candidate in 64 bits.
    pub tries_64_bits: bool,
    closed: Option<SmallOscillations<f32>>,
    /// The lengths of the rods over the tolerance, so that a bob may be off by 1.
    rods: [f32; 2],
    /// The first three runs, plain `f32`, the closed form, the coarse and the fine run in 64 bits.
    pub candidates: [Candidate; 7],
    /// True if the error by rounding is larger than that by truncation: of the single candidate, or of
    /// the fine run.
    by_rounding: bool,
}

impl Trial {
    /// Creates a trial of `stepping`, compared with `reference` if one is given.
    ///
    /// `stepping` may be in 64 bits if a reference is given: then the trial has no candidates in 32
    /// bits. `shadow` is the method and step count of the shadows.
    pub fn new(
        stepping: Stepping,
        problem: &Problem,
        reference: Option<Pair>,
        shadow: Stepping,
    ) -> Self {
        let is_in_32_bits = stepping.method != Method::Extrapolation10Fixed64;
        let [own, second, third] = tried(stepping);
        let [plain, closed] = [Method::Rk4F32DirectionPlain, Method::ClosedFormF32]
            .map(|method| Stepping { method, ..stepping });
        let single = match reference {
            Some(_) => [own, second, third, plain, third],
            None => {
                let [first, second, third] = steps_beside(stepping);
                [own, first, second, plain, third]
            }
        };

        let pair = reference.unwrap_or(Pair {
            coarse: stepping,
            fine: stepping,
        });
        let mut candidates =
            [own, second, third, plain, closed, pair.coarse, pair.fine].map(Candidate::new);
        for candidate in &mut candidates {
            candidate.judge_steps = reference.map_or(u32::MAX, |pair| pair.fine.steps);
        }
        candidates[0].failed = !is_in_32_bits;
        for several in &mut candidates[1..=THIRD] {
            several.failed = !is_in_32_bits || reference.is_none();
        }
        candidates[PLAIN].failed = stepping.method != Method::Rk4F32Direction;
        for in_64_bits in &mut candidates[COARSE..] {
            in_64_bits.failed = reference.is_none();
        }

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
            single: single.map(Run::new),
            double: [pair.coarse, pair.fine].map(Run::new),
            reference,
            shadows: Shadows::new(shadow, problem, pair.fine.steps),
            tries_64_bits: false,
            closed: closed.ok().map(|closed| closed.oscillations),
            rods: [pendulum.l1, pendulum.l2].map(|l| (l / problem.tolerance) as f32),
            candidates,
            by_rounding: false,
        }
    }

    /// Returns true if the trial is compared with a reference in 64 bits.
    pub fn has_reference(&self) -> bool {
        self.reference.is_some()
    }

    /// Returns the cost of a frame of a trial of `stepping` that is compared with `reference`, without
    /// shadows.
    pub fn cost_with_reference(
        costs: &Costs,
        stepping: Stepping,
        Pair { coarse, fine }: Pair,
    ) -> f32 {
        let [own, second, third] = if stepping.method == Method::Extrapolation10Fixed64 {
            [0.0; 3]
        } else {
            tried(stepping).map(|stepping| costs.of_frame(stepping))
        };
        own + second + third + costs.of_frame(coarse) + costs.of_frame(fine)
    }

    /// Returns true if a candidate in 32 bits, or the closed form, has not failed.
    pub fn has_candidate_in_32_bits(&self) -> bool {
        self.candidates[..=CLOSED].iter().any(|one| !one.failed)
    }

    /// Returns the largest number of accurate frames of a candidate in 32 bits.
    pub fn frames_in_32_bits(&self) -> u32 {
        let frames = self.candidates[..=CLOSED]
            .iter()
            .map(|one| one.accurate_frames);
        frames.max().unwrap_or(0)
    }

    /// Returns true if a candidate in 64 bits has not failed.
    pub fn has_candidate_in_64_bits(&self) -> bool {
        self.candidates[COARSE..].iter().any(|one| !one.failed)
    }

    /// Returns the runs in 32 bits that are still needed, by their places.
    fn single(&mut self) -> impl Iterator<Item = (usize, &mut Run<SingleRun>)> {
        let all = self.reference.is_none();
        let [own, second, third, plain, ..] = self.candidates.map(|one| !one.failed);
        let needed = [all || own, all || second, all || third, plain, all];
        let runs = self.single.iter_mut().enumerate().zip(needed);
        runs.filter(|(_, is_needed)| *is_needed).map(|(run, _)| run)
    }

    /// Returns the runs of the reference, if there is one.
    fn double(&mut self) -> &mut [Run<DoubleRun>] {
        if self.reference.is_some() {
            &mut self.double
        } else {
            &mut []
        }
    }

    /// Returns the shadows, if a candidate in 64 bits needs them.
    fn shadows(&mut self) -> impl Iterator<Item = &mut Run<SingleRun>> {
        let are_needed = self.has_candidate_in_64_bits();
        self.shadows.runs().filter(move |_| are_needed)
    }

    /// Prepares one motion. Returns false if all motions are prepared.
    ///
    /// If the method refuses the perturbed start, the opposite perturbation is tried, because a start
    /// just within the range of a method may have its neighbour on one side outside.
    #[inline(never)]
    pub fn prepare(&mut self, problem: &Problem) -> Result<bool, Error> {
        let has_reference = self.has_reference();
        let start = Pendulum::new(&problem.pendulum)?.to_state(&problem.start);
        let per_second = |steps: u32| f64::from(problem.rate) * f64::from(steps);

        if let Some((place, run)) = self.single().find(|(_, run)| run.motion.is_none()) {
            let by = match place {
                _ if has_reference => NONE,
                0 | PLAIN => NONE,
                1 | 2 => PERTURBATIONS[place - 1],
                _ => PERTURBATIONS[2],
            };
            let Stepping { method, steps } = run.stepping;
            let prepared = |by| {
                let given = problem.perturbed(&start, by, method);
                SingleRun::new(method, &given, per_second(steps))
            };
            run.motion = Some(prepared(by).or_else(|_| prepared(by.map(|by| -by)))?);
            return Ok(true);
        }

        if let Some(run) = self.double().iter_mut().find(|run| run.motion.is_none()) {
            let dt = 1.0 / per_second(run.stepping.steps);
            run.motion = Some(DoubleRun::new(&problem.pendulum, &start, dt)?);
            return Ok(true);
        }

        if self.has_candidate_in_64_bits() {
            return self.shadows.prepare(problem, &self.fine_state(&start));
        }
        Ok(false)
    }

    /// Returns true if a motion must be prepared before the next frame.
    pub fn must_prepare(&self) -> bool {
        self.has_candidate_in_64_bits() && self.shadows.must_prepare()
    }

    /// Returns the state of the fine run, or `start` before its first step.
    fn fine_state(&self, start: &State<f64>) -> State<f64> {
        let [_, fine] = &self.double;
        match &fine.motion {
            Some(motion) if self.shadows.has_begun() => motion.state(),
            _ => *start,
        }
    }

    /// Makes steps of one motion towards the next frame, as many as `cost` pays for and at least one.
    ///
    /// Returns their cost; 0 if every motion has reached the frame.
    pub fn advance(&mut self, costs: &Costs, cost: f32) -> f32 {
        let mut spent = 0.0;
        for (_, run) in self.single() {
            spent = run.advance(costs, cost);
            if spent > 0.0 {
                return spent;
            }
        }
        for run in self.double() {
            spent = run.advance(costs, cost);
            if spent > 0.0 {
                return spent;
            }
        }
        for run in self.shadows() {
            spent = run.advance(costs, cost);
            if spent > 0.0 {
                break;
            }
        }
        spent
    }

    /// Compares the frames at time `t`, s, when all steps towards them are made. A candidate fails
    /// where it may be off by more than the tolerance.
    pub fn compare(&mut self, t: f64) {
        let [own, second, third, plain, fourth] = self.single.each_mut().map(Run::frame);
        let closed = self
            .closed
            .map_or([[f32::NAN; 2]; 2], |motion| motion.directions(t));
        let in_32_bits = [own, second, third, plain, closed];

        let Some(pair) = self.reference else {
            let others = [second, third, fourth].map(|other| distance(self.rods, &own, &other));
            let greatest = others.into_iter().fold(0.0, greater);
            self.by_rounding = others.into_iter().any(|other| 2.0 * other < greatest);
            let bound = BESIDE_FINER_STEPS * greatest;
            for (candidate, shown) in self.candidates.iter_mut().zip(in_32_bits) {
                let beside = distance(self.rods, &shown, &own);
                candidate.note(beside + greatest, beside + bound);
            }
            return;
        };

        // The error of the reference.
        let [coarse, fine] = self.double.each_mut().map(Run::frame);
        let spread = distance(self.rods, &coarse, &fine);
        let of_fine = spread * pair.share_of_fine();
        for (candidate, shown) in self.candidates.iter_mut().zip(in_32_bits) {
            let beside = distance(self.rods, &shown, &fine);
            candidate.note(beside + of_fine, BESIDE_REFERENCE * beside + of_fine);
        }

        // Its candidates are judged by the growth of their roundings, too.
        if self.has_candidate_in_64_bits() {
            let rounding = self.shadows.compare(self.rods, &fine);
            let of_coarse = BESIDE_REFERENCE * spread + of_fine;
            self.by_rounding = if self.candidates[FINE].failed {
                rounding > of_coarse
            } else {
                rounding > of_fine
            };
            self.candidates[COARSE].note(spread, of_coarse + rounding);
            self.candidates[FINE].note(of_fine, of_fine + rounding);
        }
    }

    /// Excludes the candidates in 64 bits: the reference is too coarse for them.
    pub fn exclude_64_bits(&mut self) {
        for in_64_bits in &mut self.candidates[COARSE..] {
            in_64_bits.failed = true;
        }
    }

    /// Returns true if the fine run has failed because of its roundings, which no finer steps reduce.
    pub fn is_limited_by_rounding(&self) -> bool {
        self.by_rounding
    }

    /// Excludes all candidates, because their roundings may be alike in all runs.
    pub fn exclude_for_rounding(&mut self) {
        self.retain(|_| false);
        self.by_rounding = true;
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
        let (helps, times) = if self.has_reference() {
            (third.has_longer_horizon(second), 8)
        } else {
            (!self.by_rounding, 2)
        };
        helps.then_some(times)
    }

    /// Returns the cost of a frame of all runs that are still needed.
    pub fn frame_cost(&mut self, costs: &Costs) -> f32 {
        let closed = if self.candidates[CLOSED].failed {
            0.0
        } else {
            costs.of_frame(self.candidates[CLOSED].stepping)
        };
        let single = self.single().map(|(_, run)| costs.of_frame(run.stepping));
        let single: f32 = single.sum();
        let double = self.double().iter().map(|run| costs.of_frame(run.stepping));
        let double: f32 = double.sum();
        let shadows = self.shadows().map(|run| costs.of_frame(run.stepping));
        closed + single + double + shadows.sum::<f32>()
    }
}
