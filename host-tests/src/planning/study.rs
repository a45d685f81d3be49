//! Many scenes, each planned, carried out and compared with the exact motion.

use std::ops::Range;
use std::thread;

use double_pendulum::plan::{HALF_PIXEL, Plan, Scene, plan};
use double_pendulum::{Error, Pendulum};

use super::draw::scenes;
use super::judge::{Verdict, judge};
use super::target::Chip;

/// A scene with its plan and what became of it.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// Its place in the drawing, from 0.
    pub number: usize,
    /// The scene.
    pub scene: Scene,
    /// The plan.
    pub plan: Plan,
    /// What became of it.
    pub verdict: Verdict,
}

/// For how long the chip may look ahead, s of its time.
pub const PLANNING: f32 = 2.0;

/// How long the scenes of a study last, s.
pub const DURATIONS: Range<f64> = 2.0..30.0;

/// More than this, pixels, no picture may be wrong before its promised horizon.
pub const GROSS: f64 = 2.0;

impl Case {
    /// Whether half a pixel was kept until the promised horizon.
    pub fn is_kept(&self) -> bool {
        self.verdict.error <= f64::from(HALF_PIXEL)
    }

    /// The promised horizon over the true one; 1 if neither is before the first picture.
    pub fn share(&self) -> f64 {
        if self.verdict.horizon > 0.0 { self.plan.horizon / self.verdict.horizon } else { 1.0 }
    }

    /// Whether the true horizon is within the scene.
    pub fn ends_early(&self) -> bool {
        self.verdict.horizon < self.scene.duration
    }

    /// What kind of scene it is.
    pub fn class(&self) -> Result<Class, Error> {
        let pendulum = Pendulum::new(self.scene.pendulum)?;
        let start = self.scene.start;
        Ok(if self.scene.pendulum.mass_ratio() > LIGHT_ELBOW {
            Class::LightElbow
        } else if start.a1.abs().max(start.a2.abs()) < SMALL {
            Class::Small
        } else if pendulum.cannot_turn_over(&pendulum.state(&start)) {
            Class::Swinging
        } else {
            Class::Free
        })
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

/// `count` scenes by `seed`, planned for `chip`; `tick` is called after each.
pub fn study(
    seed: u64,
    count: usize,
    seconds: Range<f64>,
    chip: &Chip,
    tick: impl Fn() + Sync,
) -> Result<Vec<Case>, Error> {
    let scenes: Vec<_> = scenes(seed, seconds).take(count).enumerate().collect();
    let case = |&(number, scene): &(usize, Scene)| {
        let plan = plan(&scene, &chip.costs, &chip.budget(scene.rate, PLANNING))?;
        let verdict = judge(&scene, &plan)?;
        tick();
        Ok(Case { number, scene, plan, verdict })
    };
    let workers = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        let every = |first: usize| scenes.iter().skip(first).step_by(workers).map(case).collect::<Vec<_>>();
        let threads: Vec<_> = (0..workers).map(|first| scope.spawn(move || every(first))).collect();
        let mut cases = Vec::with_capacity(count);
        for thread in threads {
            match thread.join() {
                Ok(done) => cases.extend(done.into_iter().collect::<Result<Vec<_>, Error>>()?),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        cases.sort_by_key(|case: &Case| case.number);
        Ok(cases)
    })
}

/// The middle of `values`; 1 of none.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(1.0)
}
