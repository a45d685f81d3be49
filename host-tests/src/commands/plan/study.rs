//! Many scenes, each planned, carried out and compared with the exact motion.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use double_pendulum::plan::{Limit, Plan, PlanError, Problem};
use double_pendulum::{Error, Pendulum};
use firmware::config::HALF_PIXEL;

use super::judge::{Verdict, judge};
use super::target::Chip;

/// A scene with its plan and what became of it.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its place in the drawing, from 0.
    pub number: usize,
    /// The scene.
    pub scene: Problem,
    /// The plan; if nothing holds, what forbids it.
    pub plan: Result<Plan, Limit>,
    /// What became of it; nothing without one.
    pub verdict: Verdict,
}

/// How long the scenes of a study last, s.
pub const DURATIONS: Range<f64> = 2.0..30.0;

/// More than this, pixels, no frame may be wrong before its promised horizon.
pub const GROSS: f64 = 2.0;

impl Case {
    /// Whether half a pixel was kept until the promised horizon.
    pub fn is_kept(&self) -> bool {
        self.verdict.error <= f64::from(HALF_PIXEL)
    }

    /// The promised horizon, s; 0 if nothing is promised.
    pub fn promised(&self) -> f64 {
        self.plan.map_or(0.0, |plan| plan.horizon)
    }

    /// The promised horizon over the true one; 0 if nothing is promised.
    pub fn share(&self) -> f64 {
        if self.verdict.horizon > 0.0 { self.promised() / self.verdict.horizon } else { 0.0 }
    }

    /// Whether the true horizon is within the scene.
    pub fn ends_early(&self) -> bool {
        self.verdict.horizon < self.scene.duration
    }
}

/// From here on m2/m1 makes bob 1 snap through the straight position.
const LIGHT_ELBOW: f64 = 30.0;

/// Angles below this, rad, are small.
const SMALL: f64 = 0.2;

/// Kinds of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Angles below 0.2 rad.
    Small,
    /// Certified: no rod ever turns over.
    Swinging,
    /// A rod may turn over.
    Free,
    /// Bob 2 is more than 30 times as heavy as bob 1.
    LightElbow,
}

impl Class {
    /// What kind of scene it is.
    pub fn of(scene: &Problem) -> Result<Self, Error> {
        let pendulum = Pendulum::new(scene.pendulum)?;
        let start = scene.start;
        Ok(if scene.pendulum.mass_ratio() > LIGHT_ELBOW {
            Class::LightElbow
        } else if start.a1.abs().max(start.a2.abs()) < SMALL {
            Class::Small
        } else if pendulum.cannot_turn_over(&pendulum.to_state(&start)) {
            Class::Swinging
        } else {
            Class::Free
        })
    }

    /// Every class.
    pub const ALL: [Class; 4] = [Class::Small, Class::Swinging, Class::Free, Class::LightElbow];

    /// In words.
    pub const fn name(self) -> &'static str {
        match self {
            Class::Small => "small: below 0.2 rad",
            Class::Swinging => "no rod can turn over",
            Class::Free => "a rod may turn over",
            Class::LightElbow => "light elbow: m2 > 30 m1",
        }
    }
}

/// `scenes` planned for `chip` and carried out; `tick` is called after each.
pub fn study(
    scenes: impl IntoIterator<Item = Problem>,
    chip: &Chip,
    tick: impl Fn() + Sync,
) -> Result<Vec<Case>, PlanError> {
    let scenes: Vec<_> = scenes.into_iter().enumerate().collect();
    let case = |&(number, scene): &(usize, Problem)| -> Result<Case, PlanError> {
        let plan = chip.plan(&scene)?;
        let verdict = plan.map_or(Ok(Verdict::default()), |plan| judge(&scene, &plan))?;
        tick();
        Ok(Case { number, scene, plan, verdict })
    };
    spread(&scenes, case)
}

/// What `work` makes of each item, in their order, on as many threads as there are processors.
pub(super) fn spread<T: Sync, R: Send>(
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
