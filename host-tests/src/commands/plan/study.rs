//! Many scenes, each planned, carried out and compared with the exact motion.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use double_pendulum::plan::{Limit, Plan, PlanError, Problem};
use firmware::config::HALF_PIXEL;

use super::judge::{Exact, Verdict, judge};
use super::target::Chip;

/// A scene with its plan and what became of it.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its place in the drawing, from 0.
    pub number: usize,
    /// What it is planned for.
    pub chip: Chip,
    /// The scene.
    pub scene: Problem,
    /// The plan; if nothing holds, what forbids it.
    pub plan: Result<Plan, Limit>,
    /// What became of it; nothing without one.
    pub verdict: Verdict,
}

/// How long the scenes of a study last, s.
pub const DURATIONS: Range<f64> = 2.0..30.0;

impl Case {
    /// Whether a frame was more than half a pixel off before the predicted horizon.
    pub fn is_violation(&self) -> bool {
        self.verdict.error > f64::from(HALF_PIXEL)
    }

    /// The predicted horizon over the true one; 0 if nothing holds.
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
    let by_scene = spread(&scenes, |&(number, scene)| {
        let mut exact = Exact::new(&scene);
        let case = |&chip: &Chip| -> Result<Case, PlanError> {
            let plan = chip.plan(&scene)?;
            let verdict = plan.map_or(Ok(Verdict::default()), |plan| judge(&mut exact, &plan))?;
            Ok(Case { number, chip, scene, plan, verdict })
        };
        let cases = chips.iter().map(case).collect::<Result<Vec<_>, _>>()?;
        tick();
        Ok(cases)
    })?;
    Ok(by_scene.concat())
}

/// What `work` makes of each item, in their order, on as many threads as there are processors.
fn spread<T: Sync, R: Send>(
    items: &[T],
    work: impl Fn(&T) -> Result<R, PlanError> + Sync,
) -> Result<Vec<R>, PlanError> {
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let (next, work) = (&AtomicUsize::new(0), &work);
    let mut done = thread::scope(|scope| {
        let every = || {
            let taken = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
            taken.map_while(|at| Some((at, work(items.get(at)?)))).collect::<Vec<_>>()
        };
        let threads: Vec<_> = (0..workers).map(|_| scope.spawn(every)).collect();
        let done = threads.into_iter().map(|thread| thread.join());
        done.flat_map(|done| done.unwrap_or_else(|panic| std::panic::resume_unwind(panic))).collect::<Vec<_>>()
    });
    done.sort_by_key(|(at, _)| *at);
    done.into_iter().map(|(_, result)| result).collect()
}

/// The middle of `values`; 1 of none.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(1.0)
}
