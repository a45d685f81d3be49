//! A race: the candidates run side by side with the reference, and each leaves when it is
//! inaccurate.

use super::candidate::{Candidate, distance};
use super::entry::{Course, Entry};
use super::reference::Reference;
use super::run::{Directions, Run};
use super::uncertainty::{SHADOWS, Uncertainty};
use super::{Costs, Problem, Stepping};
use crate::error::Error;
use crate::methods::any::{Motion32, Motion64};
use crate::table::Method;

/// The largest number of candidates in 32 bits: the closed form and RK4.
pub(super) const IN_32_BITS: usize = 7;
/// The largest number of all candidates. The last one is in 64 bits.
pub(super) const CANDIDATES: usize = IN_32_BITS + 1;

/// A race in progress.
///
/// For each frame, call [`prepare`](Self::prepare) until it returns false, then
/// [`advance`](Self::advance) until all motions [are there](Self::is_there), and then
/// [`compare`](Self::compare).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Race {
    /// The last compared frame.
    pub compared: u32,
    pub candidates: [Candidate; CANDIDATES],
    runs: [Run<Motion32>; IN_32_BITS],
    /// The candidate in 64 bits. It does not run if it has the steps of the reference.
    in_64_bits: Run<Motion64>,
    reference: Reference,
    uncertainty: Uncertainty,
    /// True if the error of the reference is too large or unknown in the next frame. The race is over.
    pub is_reference_lost: bool,
    /// True if finer steps of the reference would not make its error smaller.
    pub is_finest: bool,
    pub course: Course,
    /// The lengths of the rods divided by the tolerance.
    rods: [f32; 2],
}

impl Race {
    /// Creates a race whose motions are not prepared yet.
    #[inline(never)] // It is written to its place; a copy on the stack would be large.
    pub fn new(entry: &Entry, course: &Course, problem: &Problem, costs: &Costs) -> Self {
        let reference = Stepping {
            method: Method::Extrapolation10Fixed64,
            steps: entry.steps,
        };
        let stepping = |i: usize| entry.candidates[i].unwrap_or(reference);
        let Problem {
            pendulum,
            tolerance,
            ..
        } = problem;
        Self {
            compared: 0,
            candidates: core::array::from_fn(|i| Candidate {
                is_alive: entry.candidates[i].is_some(),
                ..Candidate::new(stepping(i), costs)
            }),
            runs: core::array::from_fn(|i| Run::new(stepping(i))),
            in_64_bits: Run::new(stepping(CANDIDATES - 1)),
            reference: Reference::new(Run::new(reference)),
            uncertainty: Uncertainty::new(course),
            is_reference_lost: false,
            is_finest: entry.is_finest,
            course: *course,
            rods: [pendulum.l1, pendulum.l2].map(|l| (l / tolerance) as f32),
        }
    }

    /// Takes over the accurate frames of the same candidates in an earlier race.
    pub fn keep(&mut self, earlier: &[Candidate]) {
        for candidate in &mut self.candidates {
            let same = earlier
                .iter()
                .find(|one| one.stepping == candidate.stepping);
            if let Some(&Candidate { frames, error, .. }) = same {
                candidate.frames = frames;
                candidate.error = error;
            }
        }
    }

    /// Returns the number of steps per frame of the reference.
    pub fn steps(&self) -> u32 {
        self.reference.run.stepping.steps
    }

    /// Returns true if any candidate is alive.
    pub fn is_alive(&self) -> bool {
        self.candidates.iter().any(|candidate| candidate.is_alive)
    }

    /// Removes all candidates but this one.
    pub fn retain(&mut self, stepping: Stepping) {
        for candidate in &mut self.candidates {
            candidate.is_alive &= candidate.stepping == stepping;
        }
    }

    /// Returns true if a candidate in 64 bits runs beside the reference.
    fn runs_in_64_bits(&self) -> bool {
        let [.., candidate] = &self.candidates;
        candidate.is_alive && candidate.stepping != self.reference.run.stepping
    }

    /// Prepares one motion, or restarts the shadows if that is due. Returns false if there is
    /// nothing to prepare. A candidate that refuses the motion leaves the race.
    ///
    /// # Errors
    ///
    /// Returns the error of the reference or of a shadow that refuses the motion.
    #[inline(never)] // Counted by its name.
    pub fn prepare(&mut self, problem: &Problem) -> Result<bool, Error> {
        if self.compared > 0 {
            let is_due = self.uncertainty.is_due;
            if let (true, Some(motion)) = (is_due, &self.reference.run.motion) {
                self.uncertainty.restart(motion);
            }
            return Ok(is_due);
        }

        let start = self.course.start;
        if self.reference.run.motion.is_none() {
            self.reference.prepare(problem, &start)?;
            return Ok(true);
        }
        for (candidate, run) in self.candidates.iter_mut().zip(&mut self.runs) {
            if candidate.is_alive && run.motion.is_none() {
                candidate.is_alive = run.prepare(problem, &start).is_ok();
                return Ok(true);
            }
        }
        if self.runs_in_64_bits() && self.in_64_bits.motion.is_none() {
            let [.., candidate] = &mut self.candidates;
            candidate.is_alive = self.in_64_bits.prepare(problem, &start).is_ok();
            return Ok(true);
        }
        self.uncertainty.prepare(problem, &start)
    }

    /// Returns true if a motion may have to be prepared, or if the shadows must be restarted.
    pub fn is_preparing(&self) -> bool {
        self.compared == 0 || self.uncertainty.is_due
    }

    /// Makes steps of several motions towards the next frame, for at most `cost` but at least one.
    /// Returns their cost.
    pub fn advance(&mut self, costs: &Costs, cost: f32) -> f32 {
        let mut spent = 0.0;
        for (candidate, run) in self.candidates.iter().zip(&mut self.runs) {
            if candidate.is_alive {
                spent += run.advance(costs.of_step(run.stepping), cost, spent);
            }
        }
        if self.runs_in_64_bits() {
            spent += self.in_64_bits.advance(costs.fixed64, cost, spent);
        }
        spent += self.reference.advance(costs.fixed64, cost, spent);
        spent + self.uncertainty.advance(costs, cost, spent)
    }

    /// Returns true if every motion has arrived at the next frame.
    pub fn is_there(&self) -> bool {
        let candidates = self.candidates.iter().zip(&self.runs);
        let mut in_32_bits = candidates.filter(|(candidate, _)| candidate.is_alive);
        in_32_bits.all(|(_, run)| run.is_there())
            && (!self.runs_in_64_bits() || self.in_64_bits.is_there())
            && self.reference.run.is_there()
            && self.uncertainty.is_there()
    }

    /// Returns the cost of the next frame.
    pub fn cost(&self, costs: &Costs) -> f32 {
        let [in_32_bits @ .., in_64_bits] = &self.candidates;
        let alive = in_32_bits.iter().filter(|one| one.is_alive);
        let in_32_bits: f32 = alive.map(|one| one.cost).sum();
        let in_64_bits = if self.runs_in_64_bits() {
            in_64_bits.cost
        } else {
            0.0
        };
        let reference = costs.of_frame(self.reference.run.stepping);
        let shadows = SHADOWS as f32 * costs.of_frame(self.uncertainty.stepping());
        in_32_bits + in_64_bits + reference + shadows + costs.comparison
    }

    /// Compares all candidates with the reference in the next frame. All motions must have arrived.
    /// Nothing is known of that frame if the reference is lost.
    #[inline(never)] // Counted by its name.
    pub fn compare(&mut self) {
        let runs_in_64_bits = self.runs_in_64_bits();
        let compared = self.reference.compare(self.uncertainty.scales);
        let own = self.uncertainty.compare(self.rods, &compared);
        let is_known = own <= 1.0;
        self.is_reference_lost = !is_known;
        if self.is_reference_lost {
            return;
        }
        self.compared += 1;

        let reference = &compared.directions;
        let rods = self.rods;
        let bound = |shown: &Directions| own + distance(rods, shown, reference);
        let [in_32_bits @ .., in_64_bits] = &mut self.candidates;
        for (candidate, run) in in_32_bits.iter_mut().zip(&mut self.runs) {
            if candidate.is_alive {
                candidate.note(self.compared, bound(&run.frame()));
            }
        }
        let bound = if runs_in_64_bits {
            bound(&self.in_64_bits.frame())
        } else {
            bound(reference)
        };
        in_64_bits.note(self.compared, bound);
    }
}
