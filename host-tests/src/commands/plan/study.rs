//! Many scenes, each planned, carried out and compared with the exact motion.

use std::ops::Range;

use double_pendulum::plan::{Limit, Plan, PlanError, Problem};
use firmware::config::HALF_PIXEL;
use rayon::prelude::*;

use super::judge::{Exact, Outcome, judge};
use super::target::{CHIPS, Chip};
use crate::commands::count::ERROR_BAR;
use crate::commands::table::{Table, small};

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

/// `scenes` planned for each of `chips` and carried out; `tick` is called after each scene.
pub fn study(
    scenes: impl IntoIterator<Item = Problem>,
    chips: &[Chip],
    tick: impl Fn() + Sync,
) -> Result<Vec<Case>, PlanError> {
    let scenes: Vec<_> = scenes.into_iter().enumerate().collect();
    let by_scene = scenes.par_iter().map(|&(number, scene)| {
        let mut exact = Exact::new(&scene);
        let case = |&chip: &Chip| -> Result<Case, PlanError> {
            let plan = chip.plan(&scene)?;
            let verdict = plan.map_or(Ok(Outcome::default()), |plan| judge(&mut exact, &plan))?;
            Ok(Case { number, chip, scene, plan, verdict })
        };
        let cases = chips.iter().map(case).collect::<Result<Vec<_>, _>>()?;
        tick();
        Ok(cases)
    });
    Ok(by_scene.collect::<Result<Vec<_>, PlanError>>()?.concat())
}

/// The middle of `values`; 1 of none.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(1.0)
}

/// What the predictions are worth, for each chip that was studied.
pub fn summary(cases: &[Case]) -> Table {
    let row = |chip: &Chip| {
        let cases: Vec<&Case> = cases.iter().filter(|case| case.chip == *chip).collect();
        let pick = |which: fn(&Case) -> bool| cases.iter().copied().filter(move |case| which(case));
        let share = |which: fn(&Case) -> bool| format!("{:.2}", median(pick(which).map(Case::share)));
        let counts: [fn(&Case) -> bool; 4] =
            [|_| true, |case| case.plan.is_err(), Case::ends_early, Case::is_violation];
        let mut row = vec![chip.title.to_owned()];
        row.extend(counts.map(|which| pick(which).count().to_string()));
        row.push(small(cases.iter().map(|case| case.verdict.error).fold(0.0, f64::max)));
        row.extend([share(|case| case.plan.is_ok()), share(Case::ends_early)]);
        row.push(format!("{:.0}", median(cases.iter().filter_map(|case| Some(case.plan.ok()?.cost.into())))));
        row
    };
    Table {
        title: "Plans",
        note: format!(
            "Every scene is planned for each processor, carried out and compared with the reference at each frame. No method: \
             none that is affordable meets the tolerance in any frame. End early: cease to be right to half a pixel within the scene. \
             Violations: scenes with a frame more than half a pixel off before the predicted horizon. Largest error: until then. \
             Predicted: the predicted horizon over the true one in the median, of all scenes with a plan and of those that end early. Cycles: \
             the median. {ERROR_BAR}",
        ),
        columns: &[
            "processor",
            "scenes",
            "no method",
            "end early",
            "violations",
            "largest error (pixels)",
            "predicted (all)",
            "predicted (ending early)",
            "cycles a frame",
        ],
        rows: CHIPS.iter().map(row).filter(|row| row[1] != "0").collect(),
    }
}
