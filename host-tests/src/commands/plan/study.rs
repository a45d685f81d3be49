//! Many scenes, each planned, carried out and compared with the exact motion.

use std::ops::Range;

use double_pendulum::plan::{Limit, Plan, PlanError, Problem};
use double_pendulum::{Direction, Error, Motion, Parameters};
use firmware::config::HALF_PIXEL;
use rayon::prelude::*;
use reference::taylor::Reference;

use super::options::Chip;

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

pub type Directions = [Direction<f64>; 2];

/// The exact motion of a scene, each frame computed once, however many plans are held against it: this takes longest by far.
///
/// In `f64` as long as that is enough by far, from then on by the reference.
pub struct Exact<'a> {
    scene: &'a Problem,
    /// One, and another that starts [`APART`] from it.
    quick: [Reference<f64>; 2],
    slow: Option<Reference>,
    frames: Vec<Directions>,
}

/// What the other motion in `f64` starts apart, relative: many times what all roundings of a step come to.
const APART: f64 = 1e-13;
/// As long as both are not farther apart, pixels, neither is off by more.
const ENOUGH: f64 = 1e-2;

impl<'a> Exact<'a> {
    /// The reference is given the scene's own numbers, a plan those that its arithmetic can hold.
    pub fn new(scene: &'a Problem) -> Self {
        let Motion { a1, a2, w1, w2 } = scene.start;
        let beside = Motion { a1: a1 * (1.0 + APART), a2: a2 * (1.0 - APART), w1: w1 * (1.0 + APART), w2 };
        let quick = [scene.start, beside].map(|start| Reference::of(&scene.pendulum, &start));
        Self { scene, quick, slow: None, frames: Vec::new() }
    }

    /// Frame `frame`, from 1.
    fn frame(&mut self, frame: u32) -> Directions {
        while self.frames.len() < frame as usize {
            let next = self.next();
            self.frames.push(next);
        }
        self.frames[frame as usize - 1]
    }

    fn next(&mut self) -> Directions {
        let time = self.scene.time(self.frames.len() as u32 + 1);
        if self.slow.is_none() {
            let [one, other] = self.quick.each_mut().map(|quick| {
                quick.advance_to(time);
                directions(&quick.motion())
            });
            if distance(self.scene, &one, &other) <= ENOUGH {
                return one;
            }
        }
        let slow = self.slow.get_or_insert_with(|| Reference::new(&self.scene.pendulum, &self.scene.start));
        slow.advance_to(time);
        directions(&slow.motion())
    }
}

fn directions(motion: &Motion<f64>) -> Directions {
    [motion.a1, motion.a2].map(|a| [libm::sin(a), libm::cos(a)])
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The last time until which every frame was right to half a pixel, s; the scene's duration if all were.
    pub horizon: f64,
    /// The largest error until the predicted horizon, pixels.
    pub error: f64,
}

/// Carries out `plan` and compares each frame with the exact motion, until one is wrong and the predicted horizon is past.
pub fn judge(exact: &mut Exact, plan: &Plan) -> Result<Outcome, Error> {
    let scene = exact.scene;
    let mut motion = plan.run(scene)?;
    let mut verdict = Outcome { horizon: scene.duration, error: 0.0 };
    let mut right = true;
    for frame in 1..=scene.frames() {
        let predicted = scene.time(frame) <= plan.horizon;
        if !right && !predicted {
            break;
        }
        // One that has diverged shows nothing.
        let has_diverged = motion.advance(1).is_err();
        let shown = motion.directions().map(|axes| axes.map(|axis| if has_diverged { f64::NAN } else { axis.into() }));
        let error = distance(scene, &shown, &exact.frame(frame));
        if predicted {
            verdict.error = verdict.error.max(error);
        }
        if right && error > f64::from(HALF_PIXEL) {
            right = false;
            verdict.horizon = scene.time(frame - 1);
        }
    }
    Ok(verdict)
}

/// Pixels to a metre.
fn scale(scene: &Problem) -> f64 {
    f64::from(HALF_PIXEL) / scene.tolerance
}

/// How far the farther of the two bobs is off, pixels; infinite if anything is not a number.
fn distance(scene: &Problem, shown: &Directions, exact: &Directions) -> f64 {
    let Parameters { l1, l2, .. } = scene.pendulum;
    let scale = scale(scene);
    let off = |length: f64, rod: usize| [0, 1].map(|axis| scale * length * (shown[rod][axis] - exact[rod][axis]));
    let ([x1, y1], [x2, y2]) = (off(l1, 0), off(l2, 1));
    let (elbow, tip) = (x1.hypot(y1), (x1 + x2).hypot(y1 + y2));
    if elbow.is_finite() && tip.is_finite() { elbow.max(tip) } else { f64::INFINITY }
}
