//! Many scenes, each planned, carried out and compared with the exact motion.

use std::ops::Range;

use double_pendulum::plan::{Limit, Plan, PlanError, Problem};
use firmware::config::HALF_PIXEL;
use rayon::prelude::*;

use super::judge::{Exact, Outcome, judge};
use super::target::Chip;

/// How long the scenes of a study last, s.
pub const DURATIONS: Range<f64> = 2.0..30.0;

#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its place in the drawing, from 0.
    pub number: usize,
    pub chip: Chip,
    pub scene: Problem,
    /// The plan; if no method meets the tolerance, what forbids it.
    pub plan: Result<Plan, Limit>,
    /// What became of it; nothing without one.
    pub verdict: Outcome,
}

impl Case {
    /// Whether a frame was more than half a pixel off before the predicted horizon.
    pub fn is_violation(&self) -> bool {
        self.verdict.error > f64::from(HALF_PIXEL)
    }

    /// The predicted horizon over the true one; 0 if no method meets the tolerance.
    pub fn share(&self) -> f64 {
        let predicted = self.plan.map_or(0.0, |plan| plan.horizon);
        if self.verdict.horizon > 0.0 { predicted / self.verdict.horizon } else { 0.0 }
    }

    /// Whether it has a plan, whose true horizon is within the scene.
    pub fn ends_early(&self) -> bool {
        self.plan.is_ok() && self.verdict.horizon < self.scene.duration
    }
}

/// `scenes` planned for each of `chips` and carried out.
pub fn study(scenes: impl IntoIterator<Item = Problem>, chips: &[Chip]) -> Result<Vec<Case>, PlanError> {
    let scenes: Vec<_> = scenes.into_iter().enumerate().collect();
    let by_scene = scenes.par_iter().map(|&(number, scene)| {
        let mut exact = Exact::new(&scene);
        let case = |&chip: &Chip| -> Result<Case, PlanError> {
            let plan = chip.plan(&scene)?;
            let verdict = plan.map_or(Ok(Outcome::default()), |plan| judge(&mut exact, &plan))?;
            Ok(Case { number, chip, scene, plan, verdict })
        };
        chips.iter().map(case).collect::<Result<Vec<_>, _>>()
    });
    Ok(by_scene.collect::<Result<Vec<_>, PlanError>>()?.concat())
}

/// The middle of `values`; 1 of none.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(1.0)
}
