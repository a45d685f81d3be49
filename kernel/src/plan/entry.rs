//! The entry of a race: the participants that the budgets pay for.

use super::race::{CANDIDATES, IN_32_BITS};
use super::steps::Steps;
use super::uncertainty::{SHADOWS, most_between, scales};
use super::{Costs, Problem, Stepping};
use crate::error::Error;
use crate::pendulum::{Pendulum, State};

/// The number of motions that a race prepares at most.
const MOTIONS: usize = CANDIDATES + 1 + SHADOWS;

/// The share of the planning budget for candidates in 32 bits, after the shadows. They get more if
/// the reference leaves more. A choice: with shares of 0.2 and 0.6, 20 high starts have the same
/// mean horizon (Cortex-M3 and Cortex-M4F).
const SHARE: f32 = 0.4;

/// The start of a motion, and the steps and units of every race about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Course {
    pub start: State<f64>,
    pub shadows: Stepping,
    /// The fewest steps of a reference, and those in which rounding is its larger error.
    fewest: Stepping,
    resolving: Stepping,
    /// The units of the momenta, kg m^2/s.
    pub scales: [f64; 2],
    /// The largest number of frames between two restarts of the shadows.
    pub most: u32,
}

impl Course {
    /// Returns `None` if no method in 32 bits, or the one in 64 bits, accepts the motion.
    pub fn of(problem: &Problem, steps: &Steps, costs: &Costs) -> Result<Option<Self>, Error> {
        let pendulum = Pendulum::new(&problem.pendulum)?;
        let found = (
            steps.of_rk4(costs),
            steps.in_64_bits(0),
            steps.in_64_bits(u32::MAX),
        );
        let (Some(shadows), Some(fewest), Some(resolving)) = found else {
            return Ok(None);
        };
        Ok(Some(Self {
            start: steps.start,
            shadows,
            fewest,
            resolving,
            scales: scales(&pendulum, &steps.start),
            most: most_between(steps.admissible, problem.rate),
        }))
    }
}

/// The participants of a race, before their motions are created.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    /// `None` for unused places. The last one is in 64 bits.
    pub candidates: [Option<Stepping>; CANDIDATES],
    /// The number of steps per frame of the reference.
    pub steps: u32,
    /// True if finer steps of the reference would not make its error smaller.
    pub is_finest: bool,
}

impl Entry {
    /// Returns the participants that `planning` can pay for over `frames` frames: the candidates in
    /// 32 bits, of those that `wanted` returns for the coarsest steps of RK4, and the one in 64
    /// bits. It is `None` if planning pays for no reference.
    ///
    /// The shadows are paid for first, then the candidates in 32 bits, and the reference takes as
    /// many steps as the rest pays for, up to those in which rounding is its larger error. It has the
    /// steps of the candidate in 64 bits if more would cost too much beside that, and replaces it if
    /// it has fewer.
    pub fn of<I: Iterator<Item = Stepping>>(
        course: &Course,
        costs: &Costs,
        planning: f32,
        frames: f32,
        in_64_bits: Option<Stepping>,
        wanted: impl Fn(Stepping) -> I,
    ) -> Option<Self> {
        let &Course {
            shadows,
            fewest,
            resolving,
            most,
            ..
        } = course;
        let price = costs.fixed64;
        let of_fewest = price * fewest.steps as f32;
        let of_drawn = in_64_bits.map_or(0.0, |one| costs.of_frame(one));

        // The shadows with their restarts and comparisons. If planning cannot pay for all frames, it
        // pays for the cheapest reference and the coarsest steps of RK4 in fewer.
        let restarts = costs.preparation / most as f32;
        let of_shadows = SHADOWS as f32 * costs.of_frame(shadows) + restarts + costs.comparison;
        let needed = of_shadows + of_fewest + costs.of_frame(shadows);
        let affordable = planning - MOTIONS as f32 * costs.preparation;
        let frames = frames.min(affordable / needed);
        if frames < 1.0 {
            return None;
        }
        let mut left = affordable / frames - of_shadows;

        // The candidates in 32 bits.
        let mut candidates = [None; CANDIDATES];
        let (in_32_bits, last) = candidates.split_at_mut(IN_32_BITS);
        let of_resolving = price * resolving.steps as f32;
        let share = f32::max(SHARE * left, left - of_resolving - of_drawn);
        // The coarsest steps are part of what is needed, which rounding must not hide.
        let mut share = share.min(left - of_fewest).max(costs.of_frame(shadows));
        for (place, stepping) in in_32_bits.iter_mut().zip(wanted(shadows)) {
            let cost = costs.of_frame(stepping);
            if cost <= share {
                *place = Some(stepping);
                share -= cost;
                left -= cost;
            }
        }

        // The reference, and the candidate in 64 bits.
        let affordable = |left: f32| {
            ((left / price) as u32)
                .max(fewest.steps)
                .min(resolving.steps)
        };
        let mut steps = affordable(left);
        if let Some(drawn) = in_64_bits {
            let beside = affordable(left - of_drawn);
            steps = steps.min(beside.max(drawn.steps));
            last.fill(Some(Stepping {
                steps: steps.min(drawn.steps),
                ..drawn
            }));
        }
        Some(Self {
            candidates,
            steps,
            is_finest: steps >= resolving.steps,
        })
    }

    /// Removes all candidates but this one.
    pub fn retain(&mut self, stepping: Stepping) {
        for candidate in &mut self.candidates {
            *candidate = candidate.filter(|one| *one == stepping);
        }
    }
}
