//! A trial: several methods and step counts, run side by side and compared frame by frame.
//!
//! # The errors of a trial with a reference
//!
//! The reference is a pair of runs in 64 bits. The *fine* run has more steps, and the *coarse* run
//! has about three quarters of them. Both have the same order p = 10. The truncation error of the
//! coarse run is therefore (fine/coarse)^p times as large, and the distance between the two
//! measures it. If the steps of the fine run do not resolve the motion, its error is assumed to be
//! as large as this distance.
//!
//! The rounding errors of the two runs are too similar to be measured by their distance. Their size
//! is known where they arise. Their growth since then is measured by *shadows* ([`Shadows`]).
//!
//! | error | upper bound |
//! |---|---|
//! | fine run | a share of the distance to the coarse run, plus rounding |
//! | coarse run | the distance to the fine run, plus the error of the fine run |
//! | 32 bits, closed form | the distance to the fine run, plus its truncation error |
//!
//! Rounding means all rounding errors since the start, with their growth. A distance to the fine
//! run has a margin of a tenth. With a heavy bob 2 the bounds of truncation errors are four times
//! as large.
//!
//! # The errors of a trial without a reference
//!
//! If planning cannot pay for a reference, or if one is too expensive, a candidate in 32 bits is
//! compared with one to three *finer runs*: runs of the same method in finer steps. Their inputs
//! are perturbed by about their rounding error. The bound of the error is a multiple of the largest
//! distance to these runs. With fewer runs, the multiple is larger, because it is more probable
//! that all of them have the error of the candidate by chance.

use super::candidate::{Candidate, distance, greater};
use super::cost::{Costs, LONGEST_USUAL, Pair, Stepping};
use super::problem::{NONE, PERTURBATIONS, Problem};
use super::run::Directions;
use super::shadow::{Shadows, scales};
use crate::error::Error;
use crate::methods::any::{Motion32, Motion64};
use crate::methods::{Advance, ClosedFormF32, FormOperations, SmallOscillations};
use crate::pendulum::{Pendulum, State};
use crate::table::Method;

/// A motion of a trial. It is prepared before its first step, and then advanced from frame to
/// frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run<M> {
    /// The method and its number of steps per frame.
    pub stepping: Stepping,
    /// The number of steps since the last frame.
    made: u32,
    /// The motion; `None` until it is prepared.
    pub motion: Option<M>,
}

impl<M: Advance> Run<M> {
    /// Creates a run that has made no step towards its next frame, and whose motion is not prepared
    /// yet. `stepping` is checked when the motion is prepared, which refuses a step count of 0.
    pub fn new(stepping: Stepping) -> Self {
        Self {
            stepping,
            made: 0,
            motion: None,
        }
    }

    /// Makes steps towards the next frame: all remaining steps, or as many as `cost` pays for, but
    /// at least one.
    ///
    /// Returns the cost of these steps; 0 if no step remained. A run that is not prepared counts
    /// the steps without making them.
    #[inline(never)] // Inlined together with `frame`, it takes 0.5 KB more flash on an M4F.
    fn advance(&mut self, costs: &Costs, cost: f32) -> f32 {
        let paid = (cost
            / costs.of_frame(Stepping {
                steps: 1,
                ..self.stepping
            })) as u32;

        // Stop at the frame, but make at least one step before it.
        let left = self.stepping.steps.saturating_sub(self.made);
        let steps = left.min(paid.max(1));
        if let Some(motion) = &mut self.motion {
            motion.advance(steps);
        }
        self.made += steps;
        costs.of_frame(Stepping {
            steps,
            ..self.stepping
        })
    }

    /// Returns the directions at the frame, and begins the next frame. All steps towards the frame
    /// must have been made; this is not checked. Before the next step, a second call returns the
    /// same.
    ///
    /// The result is NaN if the motion has diverged, because its directions need not show that, or
    /// if it is not prepared.
    #[inline(never)] // Inlined together with `advance`, it takes 0.5 KB more flash on an M4F.
    pub fn frame(&mut self) -> Directions {
        self.made = 0;
        let motion = self.motion.as_ref().filter(|motion| motion.check().is_ok());
        motion.map_or([[f32::NAN; 2]; 2], M::directions)
    }
}

/// The factor on the distance to the fine run in the bound of an error. The error of the fine run
/// is added separately.
const BESIDE_REFERENCE: f32 = 1.1;

/// The factor on the bound of a truncation error in 64 bits if bob 2 is heavy.
///
/// A heavy bob 2 drives rod 1 so fast, for moments, that long steps do not resolve it, and the
/// error of the coarse run can be several times its distance to the fine run. The value is
/// measured, as the next one is. Test `all_mass_ratios_and_every_15th_degree_are_shown_as_claimed`
/// checks both against the exact motion.
const UNRESOLVED: f32 = 4.0;

/// The factor on the bound of the error of a candidate that is compared with two or three finer
/// runs, if bob 2 is heavy and rod 2 is not short.
///
/// In 32 bits of fixed point the inverse 1/(m + S^2), with m = m1/m2, then has few digits while S
/// is large. It is always rounded down, so that the errors of all these runs have the same sign.
const ROUNDED_ALIKE: f32 = 2.0;

/// The ratio of the lengths of rod 1 and rod 2 above which rod 2 is short.
const SHORT_ROD_2: f64 = 12.0;

/// The factors on the bound of the error of a candidate that is compared with two or three finer
/// runs, if rod 2 is short: in 32 bits of fixed point, and in `f32`.
///
/// The changes of the quantities of a short rod 2 have few digits, and part of their rounding is
/// the same in all these runs. The values are measured: without a factor, up to 11 of 100 similar
/// motions were inaccurate before their predicted horizon at ratios of 17 to 100, and none at 10.
/// Test `short_rods_keep_their_horizons` checks some of them against the exact motion.
const SHORT_AND_ROUNDED_ALIKE: [f32; 2] = [6.0, 4.0];

/// The smallest factor on the bound of the error of a candidate whose steps are longer than 64
/// admissible steps ([`LONGEST_USUAL`]), if it is compared with two or three finer runs.
///
/// With a heavy bob 2 such steps can be longer than the moments in which it drives rod 1 fast. In
/// the first frame after such a moment, all these runs may have a similar error. The value is
/// measured: with a factor of 2, 3 of 6,000 scenes with a heavy bob 2 were wrong on a Cortex-M3 in
/// the last frame before the predicted horizon, by up to 1.46 tolerances. A factor of 6 is enough
/// for these.
const MISSED_ALIKE: f32 = 8.0;

/// The ratio of the horizons with 4 times and with twice the steps below which finer steps gain
/// little.
///
/// In a chaotic motion each doubling of the steps adds about the same time to the horizon. Below a
/// ratio of 1.5, 32 times the steps, the finest of the next trial, then have less than twice the
/// horizon of 4 times the steps. In a regular motion, errors usually grow at most with the square
/// of the time. A doubling reduces the truncation error to 1/16, so that the ratio is at least 4.
const LITTLE: f32 = 1.5;

/// The largest bound of an error that counts as small, in units of the tolerance, where the growth
/// of errors is measured ([`Trial::errors_grow_fast`]).
const SMALL: f32 = 1.0 / 64.0;

/// The largest number of finer runs.
pub(super) const MOST_FINER_RUNS: u8 = 3;

/// The factors on the largest distance to one, two or three finer runs in the bound of an error.
///
/// The truncation error is at most 1.7 times the distance to a run with 5/4 of the steps (order 4),
/// and 1.12 times the distance to a run with 7/4. The rounding errors of the candidate and of its
/// finer runs are independent samples of one distribution. If that is the normal distribution in
/// one dimension, the probability that the error exceeds the bound is 0.0006 with each number of
/// finer runs. Test `plan_study` checks the bound against the exact motion.
const BESIDE_FINER_RUNS: [f32; MOST_FINER_RUNS as usize] = [550.0, 15.0, 4.5];

/// Returns the three finer runs of a trial without a reference: with 5/4, 6/4 and 7/4 of the steps.
/// A trial with one or two finer runs has the first of these.
///
/// In fixed point each of them has another unit of time, and therefore other constants and rounding
/// errors. Otherwise a pendulum that is almost at rest would truncate the same amount of its torque
/// in all runs.
fn finer_runs(Stepping { method, steps }: Stepping) -> [Stepping; MOST_FINER_RUNS as usize] {
    [1, 2, 3].map(|quarters: u32| {
        let more = (u64::from(steps) * u64::from(quarters) / 4) as u32;
        let steps = steps.saturating_add(if more > quarters { more } else { quarters });
        Stepping { method, steps }
    })
}

/// The runs that the candidates of a trial are compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Judges {
    /// A reference in 64 bits.
    Reference(Pair),
    /// This number of finer runs, from 1 to [`MOST_FINER_RUNS`].
    FinerRuns(u8),
}

/// Returns the candidates of a trial with a reference: with 1, 2 and 4 times the steps.
fn tried(stepping: Stepping) -> [Stepping; 3] {
    [1, 2, 4].map(|times| Stepping {
        steps: stepping.steps.saturating_mul(times),
        ..stepping
    })
}

/// Returns the candidates that are still accurate, each with its directions. The distances of the
/// others are not needed, and slow to compute without a floating-point unit.
fn accurate<'a>(
    candidates: &'a mut [Candidate],
    directions: &'a [Directions],
) -> impl Iterator<Item = (&'a mut Candidate, &'a Directions)> {
    let all = candidates.iter_mut().zip(directions);
    all.filter(|(candidate, _)| candidate.is_accurate())
}

/// The indices in [`Trial::candidates`] of the method and step count on trial, of plain `f32`, of
/// the closed form, and of the coarse and the fine run of the reference. The first two are also
/// indices in [`Trial::single`].
const OWN: usize = 0;
const PLAIN: usize = 3;
const CLOSED: usize = 4;
const COARSE: usize = 5;
const FINE: usize = 6;

/// Several methods and step counts, run side by side and compared frame by frame.
///
/// For each frame, [`prepare`](Self::prepare) is called until it returns false,
/// [`advance`](Self::advance) until it returns 0, and then [`compare`](Self::compare).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Trial {
    /// The runs in 32 bits.
    ///
    /// With a reference they are the first three candidates and plain `f32`; the fifth is unused.
    /// Without one they are a single candidate, two finer runs, plain `f32`, and the third finer
    /// run. If `finer_runs` is 1 or 2, the others are unused.
    single: [Run<Motion32>; 5],
    /// The coarse and the fine run of the reference.
    double: [Run<Motion64>; 2],
    /// The number of finer runs that the candidate is compared with. The fewer there are, the
    /// rougher the error bounds. It is 0 if the trial has a reference.
    finer_runs: u8,
    /// The shadows of the fine run. Unused while no candidate in 64 bits is accurate.
    shadows: Shadows,
    /// True if the trial began with a candidate in 64 bits. False until the caller sets it, because
    /// the caller excludes candidates after [`new`](Self::new).
    pub tries_64_bits: bool,
    /// The closed form; `None` if the pendulum has no normal modes or the start is out of range.
    closed: Option<SmallOscillations<f32>>,
    /// The lengths of the rods divided by the tolerance. Distances in this unit may be up to 1.
    rods: [f32; 2],
    /// The candidates: the first three runs, plain `f32`, the closed form, and the coarse and the
    /// fine run in 64 bits. Those that are not part of the trial are excluded.
    pub candidates: [Candidate; 7],
    /// True if the rounding error is larger than the truncation error, of the single candidate or
    /// of the fine run.
    by_rounding: bool,
    /// The number of frames before the bound of the single candidate first exceeded 1/64 of the
    /// tolerance ([`SMALL`]). It is 0 with a reference.
    pub(super) small_frames: u32,
    /// The share of the distance of the reference's runs that bounds the error of the fine run.
    share_of_fine: f32,
    /// True if bob 2 is heavy.
    is_heavy: bool,
    /// The factor on the bound of an error that is measured by two or three finer runs, for errors
    /// that the candidate and these runs have in common.
    alike: f32,
}

impl Trial {
    /// Creates a trial of `stepping` that is compared with `judges`.
    ///
    /// With a reference, the candidates are the method of `stepping` with 1, 2 and 4 times its
    /// steps, at most 2^32 - 1, and both runs of the reference. Without one, `stepping` is the only
    /// one of these. Its finer runs have 5/4, 6/4 and 7/4 of its steps, rounded down, but at least
    /// 1, 2 and 3 more. The trial has the first one, the first two or all three of them.
    ///
    /// If `stepping` is in 64 bits, a reference is required, and the trial has no candidates in 32
    /// bits. In any case, also without a reference, the closed form is a candidate, and plain `f32`
    /// is one if `stepping` is compensated `f32`. `stepping` must be neither of these two. `shadow`
    /// is the method and step count of the shadows, in 32 bits. None of this is checked here.
    ///
    /// No motion is prepared yet. A pendulum that is refused is reported by
    /// [`prepare`](Self::prepare). Without normal modes the closed form fails at the first frame.
    pub fn new(stepping: Stepping, problem: &Problem, judges: Judges, shadow: Stepping) -> Self {
        let is_in_32_bits = stepping.method != Method::Extrapolation10Fixed64;
        let [own, second, third] = tried(stepping);
        let [plain, closed] = [Method::Rk4F32DirectionPlain, Method::ClosedFormF32]
            .map(|method| Stepping { method, ..stepping });
        let (single, pair, judge_steps, finer_runs) = match judges {
            Judges::Reference(pair) => {
                let single = [own, second, third, plain, third];
                (single, pair, pair.fine.steps, 0)
            }
            Judges::FinerRuns(number) => {
                let [first, second, third] = finer_runs(stepping);
                let unused = Pair {
                    coarse: stepping,
                    fine: stepping,
                };
                ([own, first, second, plain, third], unused, u32::MAX, number)
            }
        };

        let mut candidates =
            [own, second, third, plain, closed, pair.coarse, pair.fine].map(Candidate::new);
        for candidate in &mut candidates {
            candidate.judge_steps = judge_steps;
            candidate.finer_runs = finer_runs;
        }

        // Exclude the candidates that are not part of this trial.
        let has_reference = finer_runs == 0;
        let has_several = is_in_32_bits && has_reference;
        let has_plain = stepping.method == Method::Rk4F32Direction;
        let are_tried = [
            is_in_32_bits,
            has_several,
            has_several,
            has_plain,
            true,
            has_reference,
            has_reference,
        ];
        for (candidate, is_tried) in candidates.iter_mut().zip(are_tried) {
            if !is_tried {
                candidate.exclude();
            }
        }

        let Problem {
            pendulum,
            start,
            rate,
            ..
        } = problem;

        let is_heavy = problem.has_heavy_bob_2();
        let alike = if pendulum.l1 > SHORT_ROD_2 * pendulum.l2 {
            let [in_fixed_point, in_f32] = SHORT_AND_ROUNDED_ALIKE;
            match stepping.method {
                Method::Rk4Fixed32 => in_fixed_point,
                _ => in_f32,
            }
        } else if is_heavy {
            ROUNDED_ALIKE
        } else {
            1.0
        };

        // A pendulum that is refused is reported later; until then nothing can move.
        let known = Pendulum::new(pendulum).and_then(|pendulum| {
            let start = pendulum.to_state(start);
            let scales = scales(&pendulum, &start);
            Ok((start, scales, pendulum.admissible_step(&start)?))
        });
        let nothing = (State::at_rest(0.0, 0.0), [1.0; 2], f64::INFINITY);
        let (start, scales, admissible) = known.unwrap_or(nothing);
        let step = 1.0 / (f64::from(*rate) * f64::from(stepping.steps));
        let alike = if step > LONGEST_USUAL * admissible {
            alike.max(MISSED_ALIKE)
        } else {
            alike
        };
        let closed = ClosedFormF32::new(pendulum, &start, 1.0 / f64::from(*rate));
        Self {
            single: single.map(Run::new),
            double: [pair.coarse, pair.fine].map(Run::new),
            finer_runs,
            shadows: Shadows::new(shadow, problem, scales, admissible, pair.fine.steps),
            tries_64_bits: false,
            closed: closed.ok().map(|closed| closed.oscillations),
            rods: [pendulum.l1, pendulum.l2].map(|l| (l / problem.tolerance) as f32),
            candidates,
            by_rounding: false,
            small_frames: 0,
            share_of_fine: pair.share_of_fine(*rate, admissible),
            is_heavy,
            alike,
        }
    }

    /// Returns true if the trial is compared with a reference in 64 bits.
    pub fn has_reference(&self) -> bool {
        self.finer_runs == 0
    }

    /// Returns true if the trial has no reference and fewer than three finer runs, so that more of
    /// them would give a smaller bound.
    pub fn is_rough(&self) -> bool {
        (1..MOST_FINER_RUNS).contains(&self.finer_runs)
    }

    /// Returns the number of finer runs that the candidate is compared with; 0 with a reference.
    pub fn finer_runs(&self) -> u8 {
        self.finer_runs
    }

    /// Returns the reference: the coarse and the fine run.
    pub fn reference(&self) -> Option<Pair> {
        let [coarse, fine] = self.double.each_ref().map(|run| run.stepping);
        self.has_reference().then_some(Pair { coarse, fine })
    }

    /// Returns the cost of a frame of a trial of `stepping` that is compared with `judges`, in the
    /// unit of `costs`. The closed form is not included, because it often fails early. With a
    /// reference, plain `f32` and the shadows are not included either, because these cost little in
    /// comparison. If `stepping` is in 64 bits, only the reference costs anything.
    pub fn cost(costs: &Costs, stepping: Stepping, judges: Judges) -> f32 {
        let of = |stepping| costs.of_frame(stepping);
        match judges {
            Judges::Reference(Pair { coarse, fine }) => {
                let is_in_64_bits = stepping.method == Method::Extrapolation10Fixed64;
                let own: f32 = tried(stepping).map(of).into_iter().sum();
                of(coarse) + of(fine) + if is_in_64_bits { 0.0 } else { own }
            }
            Judges::FinerRuns(number) => {
                let finer = finer_runs(stepping).map(of).into_iter();
                let plain = if stepping.method == Method::Rk4F32Direction {
                    let method = Method::Rk4F32DirectionPlain;
                    of(Stepping { method, ..stepping })
                } else {
                    0.0
                };
                of(stepping) + finer.take(number.into()).sum::<f32>() + plain
            }
        }
    }

    /// Returns true if a candidate in 32 bits, or the closed form, is still accurate, as it is
    /// before the first frame is compared. Excluded candidates do not count.
    pub fn has_candidate_in_32_bits(&self) -> bool {
        self.candidates[..=CLOSED]
            .iter()
            .any(Candidate::is_accurate)
    }

    /// Returns the largest number of accurate frames of a candidate in 32 bits or of the closed
    /// form, including those that have failed or were excluded later. It is 0 if none of them ever
    /// was part of the trial.
    pub fn frames_in_32_bits(&self) -> u32 {
        let frames = self.candidates[..=CLOSED]
            .iter()
            .map(|one| one.accurate_frames);
        frames.max().unwrap_or(0)
    }

    /// Returns true if a candidate in 64 bits is still accurate, as it is before the first frame is
    /// compared. Without a reference, or if both are excluded, there is none.
    pub fn has_candidate_in_64_bits(&self) -> bool {
        self.candidates[COARSE..].iter().any(Candidate::is_accurate)
    }

    /// Returns the runs in 32 bits that are still needed, with their indices.
    fn single(&mut self) -> impl Iterator<Item = (usize, &mut Run<Motion32>)> {
        // Without a reference, the candidate and its finer runs are always needed.
        let has = |number: u8| self.finer_runs >= number;
        let [own, second, third, plain, ..] =
            self.candidates.each_ref().map(Candidate::is_accurate);
        let needed = [
            has(1) || own,
            has(1) || second,
            has(2) || third,
            plain,
            has(3),
        ];
        let runs = self.single.iter_mut().enumerate().zip(needed);
        runs.filter(|(_, is_needed)| *is_needed).map(|(run, _)| run)
    }

    /// Returns the runs of the reference, or no runs without a reference.
    fn double(&mut self) -> &mut [Run<Motion64>] {
        if self.has_reference() {
            &mut self.double
        } else {
            &mut []
        }
    }

    /// Returns the shadows if a candidate in 64 bits needs them, or no runs.
    fn shadows(&mut self) -> impl Iterator<Item = &mut Run<Motion32>> {
        let are_needed = self.has_candidate_in_64_bits();
        self.shadows.runs().filter(move |_| are_needed)
    }

    /// Prepares one motion, gives all shadows finer steps because their method refuses the usual
    /// ones, or restarts all shadows if that is due. Returns true if it has done one of these, and
    /// false if there is nothing to prepare.
    ///
    /// Runs that are no longer needed are not prepared. `problem` must be that of
    /// [`new`](Self::new); this is not checked.
    ///
    /// If a method refuses a perturbed start, the opposite perturbation is used. A start close to
    /// the end of the range of a method may have a neighbour outside that range on one side only.
    ///
    /// # Errors
    ///
    /// Refuses a pendulum that [`Pendulum::new`] refuses. Returns the error of a method that
    /// refuses a motion; a perturbed motion or a shadow counts as refused only if its opposite is
    /// refused, too. Another call then returns the same error.
    #[inline(never)] // Its motions would be on the stack of every piece.
    pub fn prepare(&mut self, problem: &Problem) -> Result<bool, Error> {
        // A restart of all shadows.
        if self.must_prepare() {
            self.restart_shadows();
            return Ok(true);
        }

        // Creating the pendulum is expensive, so this is checked first.
        if self.is_prepared() {
            return Ok(false);
        }

        let has_reference = self.has_reference();
        let is_single = self.finer_runs == 1;
        let start = Pendulum::new(&problem.pendulum)?.to_state(&problem.start);
        let dt = |steps: u32| 1.0 / (f64::from(problem.rate) * f64::from(steps));

        // A run in 32 bits. Without a reference, the finer runs have perturbed inputs.
        if let Some((place, run)) = self.single().find(|(_, run)| run.motion.is_none()) {
            let by = match place {
                _ if has_reference => NONE,
                0 | PLAIN => NONE,
                // A single finer run must be perturbed in g/l2, which the first one is not.
                1 if is_single => PERTURBATIONS[2],
                1 | 2 => PERTURBATIONS[place - 1],
                _ => PERTURBATIONS[2],
            };

            let Stepping { method, steps } = run.stepping;
            let prepared = |by| {
                let (parameters, start) = problem.perturbed(&start, by, method);
                Motion32::new(method, &parameters, &start, dt(steps))
            };
            run.motion = Some(prepared(by).or_else(|_| prepared(by.map(|by| -by)))?);
            return Ok(true);
        }

        // A run of the reference.
        if let Some(run) = self.double().iter_mut().find(|run| run.motion.is_none()) {
            let motion = FormOperations::new(&problem.pendulum, &start, dt(run.stepping.steps))?;
            run.motion = Some(motion);
            return Ok(true);
        }

        // A shadow.
        self.shadows.prepare(problem, &start)?;
        Ok(true)
    }

    /// Returns true if all motions that are needed are prepared.
    fn is_prepared(&mut self) -> bool {
        let needs_shadows = self.has_candidate_in_64_bits();
        self.single().all(|(_, run)| run.motion.is_some())
            && self.double().iter().all(|run| run.motion.is_some())
            && (!needs_shadows || self.shadows.are_prepared())
    }

    /// Restarts all shadows at the present state of the fine run, or does nothing if that is not
    /// prepared.
    #[inline(never)] // `cargo count` finds it by its name: its cost is the price of a preparation.
    fn restart_shadows(&mut self) {
        let [_, fine] = &self.double;
        if let Some(fine) = &fine.motion {
            self.shadows.restart(&fine.state());
        }
    }

    /// Returns true if [`prepare`](Self::prepare) must restart the shadows before the next
    /// frame. Motions that are not prepared yet do not count.
    pub fn must_prepare(&self) -> bool {
        self.has_candidate_in_64_bits() && self.shadows.is_due()
    }

    /// Makes steps of one motion, or of several shadows, towards the next frame: as many as `cost`
    /// pays for, but at least one, also if `cost` is 0, negative or NaN. All motions must be
    /// prepared; this is not checked.
    ///
    /// Returns the cost of these steps, in the unit of `costs`; 0 if every motion has reached the
    /// frame. `cost` has the same unit; an infinite one pays for all steps of a motion, or
    /// of all shadows, to the frame. The prices must be more than 0.
    pub fn advance(&mut self, costs: &Costs, cost: f32) -> f32 {
        let mut spent = 0.0;

        // The runs in 32 bits advance first.
        for (_, run) in self.single() {
            spent = run.advance(costs, cost);
            if spent > 0.0 {
                return spent;
            }
        }

        // Then the coarse and the fine run of the reference.
        for run in self.double() {
            spent = run.advance(costs, cost);
            if spent > 0.0 {
                return spent;
            }
        }

        // Advance the shadows last, which only candidates in 64 bits need. They cost little, so
        // that one piece may advance several of them.
        for run in self.shadows() {
            let step = costs.of_frame(Stepping {
                steps: 1,
                ..run.stepping
            });
            if spent == 0.0 || spent + step <= cost {
                spent += run.advance(costs, cost - spent);
            }
        }
        spent
    }

    /// Compares the frames at time `t`, s since the start. Every frame after the start must be
    /// compared once, in order. All steps towards it must have been made, and `t` must be its time,
    /// at which the closed form is computed. Nothing of this is checked.
    ///
    /// A candidate fails if its error may exceed the tolerance, or if it or a run that it is
    /// compared with has diverged.
    pub fn compare(&mut self, t: f64) {
        let [own, second, third, plain, fourth] = self.single.each_mut().map(Run::frame);
        let has_closed = self.candidates[CLOSED].is_accurate();
        let closed = self
            .closed
            .filter(|_| has_closed)
            .map_or([[f32::NAN; 2]; 2], |motion| motion.directions(t));
        let in_32_bits = [own, second, third, plain, closed];

        // Without a reference: the distances of the candidate to the finer runs.
        if !self.has_reference() {
            let distances = [second, third, fourth].map(|other| distance(self.rods, &own, &other));
            let distances = distances.into_iter().take(self.finer_runs.into());
            let greatest = distances.clone().fold(0.0, greater);
            // Truncation errors give distances of 0.59, 0.80 and 0.89 of the error. If one distance
            // is less than half of another one, rounding is the larger error.
            self.by_rounding = distances.clone().any(|distance| 2.0 * distance < greatest);
            let bound = self.factor() * greatest;

            // Count the frames until the bound is no longer small. They show how errors grow.
            let candidate = &self.candidates[OWN];
            let was_small =
                candidate.is_accurate() && self.small_frames == candidate.accurate_frames;
            if was_small && bound <= SMALL {
                self.small_frames += 1;
            }
            for (candidate, shown) in accurate(&mut self.candidates, &in_32_bits) {
                let beside = distance(self.rods, shown, &own);
                candidate.note(beside + greatest, beside + bound);
            }
            return;
        }

        // With a reference: the error of the fine run by truncation, and the candidates in 32 bits.
        let [coarse, fine] = self.double.each_mut().map(Run::frame);
        let spread = distance(self.rods, &coarse, &fine);
        let of_fine = spread * self.share_of_fine;
        let unresolved = if self.is_heavy { UNRESOLVED } else { 1.0 };
        let bound_of_fine = unresolved * of_fine;
        for (candidate, shown) in accurate(&mut self.candidates, &in_32_bits) {
            let beside = distance(self.rods, shown, &fine);
            candidate.note(beside + of_fine, BESIDE_REFERENCE * beside + bound_of_fine);
        }

        // The candidates in 64 bits. Their bounds include grown rounding errors.
        if self.has_candidate_in_64_bits() {
            let rounding = self.shadows.compare(self.rods);
            let bound_of_coarse = unresolved * BESIDE_REFERENCE * spread + bound_of_fine;
            // An unknown rounding error has grown too much within a frame.
            let truncation = if self.candidates[FINE].is_accurate() {
                bound_of_fine
            } else {
                bound_of_coarse
            };
            self.by_rounding = rounding.is_nan() || rounding > truncation;

            self.candidates[COARSE].note(spread, bound_of_coarse + rounding);
            self.candidates[FINE].note(of_fine, bound_of_fine + rounding);
        }
    }

    /// Returns the factor on the largest distance to the finer runs in the bound of an error.
    ///
    /// The factor for a single finer run is not multiplied by `alike`, because it is large enough
    /// for errors in common as well.
    fn factor(&self) -> f32 {
        let [one, two, three] = BESIDE_FINER_RUNS;
        match self.finer_runs {
            1 => one,
            2 => two * self.alike,
            _ => three * self.alike,
        }
    }

    /// Excludes the candidates in 64 bits, because it is too early for them, or because the steps
    /// of the reference are too coarse for them. The reference continues without shadows.
    pub fn exclude_64_bits(&mut self) {
        for in_64_bits in &mut self.candidates[COARSE..] {
            in_64_bits.exclude();
        }
    }

    /// Returns true if rounding was the larger error, in the last frame where this was compared:
    /// of the single candidate, of the fine run or, once that has failed, of the coarse run. Finer
    /// steps do not reduce it. False before the first such frame, unless
    /// [`exclude_for_rounding`](Self::exclude_for_rounding) was called.
    pub fn is_limited_by_rounding(&self) -> bool {
        self.by_rounding
    }

    /// Excludes all candidates, because their rounding errors may be the same in all runs: in fixed
    /// point without a reference, if a rod starts close to upright. Rounding then limits the
    /// horizon ([`is_limited_by_rounding`](Self::is_limited_by_rounding)) until
    /// [`compare`](Self::compare) measures it anew, as it does without a reference.
    pub fn exclude_for_rounding(&mut self) {
        self.retain(|_| false);
        self.by_rounding = true;
    }

    /// Excludes all candidates except the `wanted` ones. A wanted candidate that has failed or is
    /// already excluded stays so.
    pub fn retain(&mut self, wanted: impl Fn(&Candidate) -> bool) {
        self.candidates
            .iter_mut()
            .filter(|candidate| !wanted(candidate))
            .for_each(Candidate::exclude);
    }

    /// Returns the factor on the step count of the next trial, or `None` if finer steps do not
    /// help.
    ///
    /// With a reference they help if 4 times the steps had a horizon more than a tenth longer than
    /// twice the steps. A trial in 64 bits has no such candidates and gives `None`. Without a
    /// reference they help unless rounding is the larger error
    /// ([`is_limited_by_rounding`](Self::is_limited_by_rounding)). A single finer run does not show
    /// rounding, so that they then seem to help as well.
    pub fn refinement(&self) -> Option<u32> {
        let [_, second, third, ..] = &self.candidates;
        let helps = if self.has_reference() {
            third.has_longer_horizon(second)
        } else {
            !self.by_rounding
        };
        helps.then_some(self.usual_factor())
    }

    /// Returns true if the candidate with 4 times the steps has a horizon less than 1.5 times
    /// ([`LITTLE`]) that of the candidate with twice the steps. An excluded candidate counts as 0
    /// frames. Returns false if neither has a frame, as without a reference or in 64 bits.
    pub fn finer_steps_gain_little(&self) -> bool {
        let [_, second, third, ..] = self.candidates.map(|one| one.accurate_frames as f32);
        third < LITTLE * second
    }

    /// Returns true if the bound of the single candidate was at most 1/64 of the tolerance for more
    /// than a quarter of its accurate frames. If it has failed, its error has then grown faster
    /// than the cube of the time, because 1/64 is the cube of a quarter. Returns false with a
    /// reference, and before a frame is accurate.
    ///
    /// In a regular motion errors usually grow at most with the square of the time. In a chaotic
    /// one they grow exponentially.
    pub fn errors_grow_fast(&self) -> bool {
        self.small_frames > self.candidates[OWN].accurate_frames / 4
    }

    /// Returns the factor on the step count of a next trial in finer steps: 8 with a reference,
    /// because 2 and 4 times the steps were candidates already, and 2 without one.
    pub fn usual_factor(&self) -> u32 {
        if self.has_reference() { 8 } else { 2 }
    }

    /// Returns the cost of a whole frame, also in the middle of one, in the unit of `costs`: of all
    /// runs that are still needed, of the closed form while it is accurate, and of the shadows
    /// while a candidate in 64 bits is. Preparations are not included. The runs of the reference
    /// or, without one, the candidate and its finer runs are always needed.
    pub fn frame_cost(&mut self, costs: &Costs) -> f32 {
        let closed = if self.candidates[CLOSED].is_accurate() {
            costs.of_frame(self.candidates[CLOSED].stepping)
        } else {
            0.0
        };

        // Only the runs that are still needed cost anything.
        let single = self.single().map(|(_, run)| costs.of_frame(run.stepping));
        let single: f32 = single.sum();
        let double = self.double().iter().map(|run| costs.of_frame(run.stepping));
        let double: f32 = double.sum();
        let shadows = self.shadows().map(|run| costs.of_frame(run.stepping));
        closed + single + double + shadows.sum::<f32>()
    }
}

#[cfg(test)]
mod tests;
