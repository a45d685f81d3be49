//! Many scenes, drawn by a seed, each planned, carried out and compared with the exact motion.

use std::f64::consts::PI;
use std::ops::Range;

use double_pendulum::plan::{Limit, Plan, PlanError, Problem};
use double_pendulum::{Direction, Error, Method, Motion, Parameters, Pendulum, State};
use fastrand::Rng;
use firmware::config::{GRAVITY, HALF_PIXEL};
use firmware::job::AnyRun;
use firmware::motion::half_pixel;
use rayon::prelude::*;
use reference::taylor::Reference;

use super::options::Chip;
use crate::oracle::random::{log_uniform, symmetric};

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

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// The last time until which every frame was right to half a pixel, s; the scene's duration if all were.
    pub horizon: f64,
    /// The largest error until the predicted horizon, pixels.
    pub error: f64,
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
    let by_scene = scenes.par_iter().map(|(number, scene)| carried_out(*number, scene, chips));
    Ok(by_scene.collect::<Result<Vec<_>, PlanError>>()?.concat())
}

/// A scene planned for each of `chips`; frame by frame, for the exact motion takes longest by far, until none is right and all
/// predicted horizons are past.
fn carried_out(number: usize, scene: &Problem, chips: &[Chip]) -> Result<Vec<Case>, PlanError> {
    let start = |&chip: &Chip| {
        let plan = chip.plan(scene)?;
        let verdict = plan.map_or(Outcome::default(), |_| Outcome { horizon: scene.duration, error: 0.0 });
        let motion = plan.ok().map(|plan| plan.run(scene)).transpose()?;
        Ok((Case { number, chip, scene: *scene, plan, verdict }, motion))
    };
    let mut cases = chips.iter().map(start).collect::<Result<Vec<_>, PlanError>>()?;
    let mut exact = Exact::new(scene)?;
    for frame in 1..=scene.frames() {
        let time = scene.time(frame);
        let is_predicted = |case: &Case| case.plan.is_ok_and(|plan| time <= plan.horizon);
        for (case, motion) in &mut cases {
            *motion = motion.take().filter(|_| is_predicted(case) || case.verdict.horizon == scene.duration);
        }
        if cases.iter().all(|(_, motion)| motion.is_none()) {
            break;
        }
        let exact = exact.next(scene, time);
        for (case, motion) in cases.iter_mut().filter_map(|(case, motion)| Some((case, motion.as_mut()?))) {
            // One that has diverged shows nothing.
            let has_diverged = motion.advance(1).is_err();
            let shown =
                motion.directions().map(|axes| axes.map(|axis| if has_diverged { f64::NAN } else { axis.into() }));
            let error = distance(scene, &shown, &exact);
            if is_predicted(case) {
                case.verdict.error = case.verdict.error.max(error);
            }
            if error > f64::from(HALF_PIXEL) {
                case.verdict.horizon = case.verdict.horizon.min(scene.time(frame - 1));
            }
        }
    }
    Ok(cases.into_iter().map(|(case, _)| case).collect())
}

/// The middle of `values`; 1 of none.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<_> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(1.0)
}

type Directions = [Direction<f64>; 2];

/// The exact motion of a scene: by extrapolation of order 16 in `f64` as long as that is enough by far, from then on by the reference.
struct Exact {
    /// One, and another that starts [`APART`] from it; each in so many steps to a frame.
    quick: [(AnyRun, u32); 2],
    slow: Option<Reference>,
}

/// What the other motion in `f64` starts apart, relative: many times what all roundings of a step come to.
const APART: f64 = 1e-13;
/// One step of the first motion, in admissible steps; the second's are half as long. Hardly any motion needs admissible steps.
const LONG: f64 = 12.0;
/// As long as both are not farther apart, pixels, neither is off by more.
const ENOUGH: f64 = 1e-2;

impl Exact {
    /// The reference is given the scene's own numbers, a plan those that its arithmetic can hold.
    fn new(scene: &Problem) -> Result<Self, Error> {
        let pendulum = Pendulum::new(&scene.pendulum)?;
        let start @ State { a1, a2, p1, p2 } = pendulum.to_state(&scene.start);
        let beside = State { a1: a1 * (1.0 + APART), a2: a2 * (1.0 - APART), p1: p1 * (1.0 + APART), p2 };
        let frame = 1.0 / f64::from(scene.rate);
        let steps = (frame / (LONG * pendulum.admissible_step(&start)?)).ceil().max(1.0) as u32;
        let run = |start, steps| {
            Ok((AnyRun::new(Method::Extrapolation16F64, &pendulum, start, frame / f64::from(steps))?, steps))
        };
        Ok(Self { quick: [run(&start, steps)?, run(&beside, 2 * steps)?], slow: None })
    }

    /// At the time of the next frame, s.
    fn next(&mut self, scene: &Problem, time: f64) -> Directions {
        let directions = |angles: [f64; 2]| angles.map(|a| [libm::sin(a), libm::cos(a)]);
        if self.slow.is_none() {
            let [one, other] = self.quick.each_mut().map(|(quick, steps)| {
                quick.advance(*steps).map_or([[f64::NAN; 2]; 2], |()| directions(quick.state().angles()))
            });
            if distance(scene, &one, &other) <= ENOUGH {
                return one;
            }
        }
        let slow = self.slow.get_or_insert_with(|| Reference::new(&scene.pendulum, &scene.start));
        slow.advance_to(time);
        directions(slow.motion().angles())
    }
}

/// How far the farther of the two bobs is off, pixels; infinite if anything is not a number.
fn distance(scene: &Problem, shown: &Directions, exact: &Directions) -> f64 {
    let Parameters { l1, l2, .. } = scene.pendulum;
    let scale = f64::from(HALF_PIXEL) / scene.tolerance;
    let off = |length: f64, rod: usize| [0, 1].map(|axis| scale * length * (shown[rod][axis] - exact[rod][axis]));
    let ([x1, y1], [x2, y2]) = (off(l1, 0), off(l2, 1));
    let (elbow, tip) = (x1.hypot(y1), (x1 + x2).hypot(y1 + y2));
    if elbow.is_finite() && tip.is_finite() { elbow.max(tip) } else { f64::INFINITY }
}

/// The height of the display, pixels: half of one may be missed.
const HEIGHT: f64 = 64.0;
const RATE: u16 = 60;
/// The least amplitude, rad.
const LEAST: f64 = 0.01;
/// The greatest velocity of a rod: over its own sqrt(g/l), and rad/s.
const GREATEST: [f64; 2] = [20.0, 60.0];

/// Any number of scenes that last as long as `seconds` says.
///
/// - mass ratio m2/m1 1e-3 .. 1e3, length ratio l2/l1 1e-2 .. 1e2, duration: evenly spread in the logarithm
/// - amplitude 0.01 .. pi rad: every other one evenly spread in the logarithm, the others evenly
/// - one angle is as large as the amplitude; the other, too, in every third scene, else anything up to it
/// - every other scene starts at rest, the others with velocities up to a share of the greatest: 20 times the rod's own
///   sqrt(g/l), at most 60 rad/s. The share 0.01 .. 1 is spread as the amplitude is
pub fn scenes(seed: u64, seconds: Range<f64>) -> impl Iterator<Item = Problem> {
    let mut rng = Rng::with_seed(seed);
    std::iter::repeat_with(move || scene(&mut rng, &seconds))
}

fn scene(rng: &mut Rng, seconds: &Range<f64>) -> Problem {
    // With gravity given, the mass and length ratios are all there is.
    let mass_ratio = log_uniform(rng, 1e-3, 1e3);
    let pendulum = Parameters { m1: 1.0, m2: mass_ratio, l1: 1.0, l2: log_uniform(rng, 1e-2, 1e2), g: GRAVITY };
    let size = |rng: &mut Rng, most| {
        if rng.bool() { log_uniform(rng, LEAST, most) } else { LEAST + (most - LEAST) * rng.f64() }
    };
    let amplitude = size(rng, PI);
    let other = amplitude * symmetric(rng);
    let [a1, a2] = match rng.u8(0..3) {
        0 => [amplitude, amplitude],
        1 => [other, amplitude],
        _ => [amplitude, other],
    };
    let mut start = Motion::at_rest(a1, a2);
    if rng.bool() {
        let share = size(rng, 1.0);
        let [of_own, in_all] = GREATEST;
        let mut velocity = |l: f64| share * symmetric(rng) * (of_own * (GRAVITY / l).sqrt()).min(in_all);
        (start.w1, start.w2) = (velocity(pendulum.l1), velocity(pendulum.l2));
    }
    let tolerance = half_pixel(&pendulum, HEIGHT);
    Problem { pendulum, start, tolerance, duration: log_uniform(rng, seconds.start, seconds.end), rate: RATE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quick_motion_is_the_references_as_long_as_it_is_taken() -> Result<(), Error> {
        let mut compared = 0;
        for scene in scenes(2, 2.0..4.0).take(8) {
            let (mut exact, mut reference) = (Exact::new(&scene)?, Reference::new(&scene.pendulum, &scene.start));
            for frame in 1..=scene.frames() {
                let quick = exact.next(&scene, scene.time(frame));
                if exact.slow.is_some() {
                    break;
                }
                if frame % 30 == 0 {
                    reference.advance_to(scene.time(frame));
                    let right = reference.motion().angles().map(|a| [libm::sin(a), libm::cos(a)]);
                    assert!(distance(&scene, &quick, &right) <= ENOUGH, "{scene:?}, frame {frame}");
                    compared += 1;
                }
            }
        }
        assert!(compared > 16, "{compared} frames");
        Ok(())
    }
}
