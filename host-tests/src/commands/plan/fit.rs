//! The planner's margins held against the exact motion: how much larger an error is than the distances that tell of it.

use std::ops::Range;

use double_pendulum::form::{Direction, DirectionForm, Fixed32Form, Fixed64Form};
use double_pendulum::plan::{Directions, ErrorEstimate, MARGIN, Method, ORDER, PlanError, Problem, ShadowedRun};
use double_pendulum::{Error, Motion, Pendulum};
use firmware::config::HALF_PIXEL;

use super::judge::distance;
use super::study::spread;
use crate::commands::table::{Table, small};
use crate::oracle::reference::Reference;

/// How long each scene is followed, s.
pub const FOLLOWED: Range<f64> = 9.0..11.0;
/// How much finer the steps become from one pass to the next, and how often.
const FINER: u32 = 8;
const PASSES: u32 = 3;
/// The most steps to a frame: finer ones would only take time.
const MOST_STEPS: u32 = 256;

/// A pass over a motion, when its error first came to half a pixel, or as far as it was followed if it never did.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The scene's place in the drawing.
    pub number: usize,
    /// By what.
    pub method: Method,
    /// Steps to a frame.
    pub steps: u32,
    /// The largest error so far, over half a pixel.
    pub error: f64,
    /// The largest distances so far.
    pub estimate: ErrorEstimate,
}

impl Sample {
    /// Whether the error came to half a pixel.
    pub fn ended(&self) -> bool {
        self.error > 1.0
    }

    /// The error over its bound.
    pub fn ratio(&self) -> f64 {
        self.error / f64::from(self.estimate.bound())
    }
}

/// The passes over `scenes`.
pub fn fit(scenes: impl IntoIterator<Item = Problem>, tick: impl Fn() + Sync) -> Result<Vec<Sample>, PlanError> {
    let scenes: Vec<_> = scenes.into_iter().enumerate().collect();
    let samples = spread(&scenes, |&(number, scene)| {
        let samples = passes(number, &scene);
        tick();
        samples
    })?;
    Ok(samples.concat())
}

fn passes(number: usize, scene: &Problem) -> Result<Vec<Sample>, PlanError> {
    let pendulum = Pendulum::new(scene.pendulum)?;
    let admissible = pendulum.admissible_step(&pendulum.to_state(&scene.start))?;
    let coarsest = (1.0 / (f64::from(scene.rate) * 4.0 * admissible)).ceil().max(1.0) as u32;
    let mut exact = Exact { scene, reference: Reference::new(&scene.pendulum, &scene.start), frames: Vec::new() };
    let mut samples = Vec::new();
    for pass in 0..PASSES {
        let steps = coarsest.next_power_of_two() * FINER.pow(pass);
        if steps <= MOST_STEPS {
            let mut float = ShadowedRun::<f32, DirectionForm<f32>>::new(scene, steps)?;
            samples.push(sample(Method::Direction, number, &mut exact, steps, || float.next_frame()));
            let mut fixed = ShadowedRun::<f32, Fixed32Form>::new(scene, steps)?;
            samples.push(sample(Method::Fixed32, number, &mut exact, steps, || fixed.next_frame()));
        }
    }
    let resolving = 2 * coarsest.next_power_of_two();
    if resolving <= MOST_STEPS {
        let mut fixed = ShadowedRun::<f64, Fixed64Form<ORDER>>::new(scene, resolving)?;
        samples.push(sample(Method::Fixed64, number, &mut exact, resolving, || fixed.next_frame()));
    }
    Ok(samples)
}

/// A form that takes no steps so long has no sample to give: its error stays 0.
fn sample(
    method: Method,
    number: usize,
    exact: &mut Exact,
    steps: u32,
    mut next: impl FnMut() -> Result<(Directions, ErrorEstimate), Error>,
) -> Sample {
    let mut sample = Sample { number, method, steps, error: 0.0, estimate: ErrorEstimate::default() };
    for frame in 1..=exact.scene.frames() {
        let Ok((shown, estimate)) = next() else { break };
        let shown = shown.map(|direction| direction.map(f64::from));
        let error = distance(exact.scene, &shown, &exact.frame(frame)) / f64::from(HALF_PIXEL);
        sample.estimate = sample.estimate.or(estimate);
        sample.error = sample.error.max(error);
        if sample.ended() {
            break;
        }
    }
    sample
}

/// The exact motion's frames, computed once.
struct Exact<'a> {
    scene: &'a Problem,
    reference: Reference,
    frames: Vec<[Direction<f64>; 2]>,
}

impl Exact<'_> {
    fn frame(&mut self, frame: u32) -> [Direction<f64>; 2] {
        while self.frames.len() < frame as usize {
            self.reference.advance_to(self.scene.time(self.frames.len() as u32 + 1));
            let Motion { a1, a2, .. } = self.reference.motion();
            self.frames.push([a1, a2].map(|a| [libm::sin(a), libm::cos(a)]));
        }
        self.frames[frame as usize - 1]
    }
}

/// How the errors compare with the planner's bounds, for passes whose error came to half a pixel.
pub fn margins(samples: &[Sample]) -> Table {
    let ended = |pick: &dyn Fn(&Sample) -> bool| samples.iter().filter(|s| s.ended() && pick(s)).collect::<Vec<_>>();
    let by_rounding = |s: &Sample| s.estimate.is_by_rounding();
    let groups = [
        ("f32, the step", ended(&|s| s.method == Method::Direction && !by_rounding(s))),
        ("f32, rounding", ended(&|s| s.method == Method::Direction && by_rounding(s))),
        ("32 bits of fixed point", ended(&|s| s.method == Method::Fixed32)),
        ("64 bits of fixed point", ended(&|s| s.method == Method::Fixed64)),
        ("all", ended(&|_| true)),
    ];
    let rows = groups.iter().map(|(name, samples)| {
        let of = |value: &dyn Fn(&Sample) -> f64, share: f64| small(quantile(samples.iter().map(|s| value(s)), share));
        let step = |s: &Sample| s.error / f64::from(s.estimate.step);
        let rounding = |s: &Sample| s.error / f64::from(s.estimate.rounding);
        vec![
            (*name).to_owned(),
            samples.len().to_string(),
            of(&step, 0.5),
            of(&step, 0.99),
            of(&rounding, 0.5),
            of(&rounding, 0.99),
            of(&Sample::ratio, 0.5),
            of(&Sample::ratio, 0.99),
            of(&Sample::ratio, 0.999),
            of(&Sample::ratio, 1.0),
            samples.iter().filter(|s| s.ratio() > 1.0).count().to_string(),
        ]
    });
    Table {
        name: "plan-margins",
        title: format!("The planner's margin of {MARGIN}"),
        note: String::from(
            "Passes over scenes whose true error came to half a pixel, by what ended them. The error then, over the distance \
             to the motion with finer steps, over the larger distance to the two with other roundings, and over the \
             bound made of both: above 1 the promise is broken. Quantiles.",
        ),
        columns: vec![
            "ended by",
            "passes",
            "over step, median",
            "99 %",
            "over rounding, median",
            "99 %",
            "over bound, median",
            "99 %",
            "99.9 %",
            "greatest",
            "above 1",
        ],
        rows: rows.collect(),
    }
}

/// The value that a `share` of all does not exceed.
fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    let last = values.len().saturating_sub(1);
    values.get((last as f64 * share).ceil() as usize).copied().unwrap_or(0.0)
}
