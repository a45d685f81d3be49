//! A plan carried out, beside the reference.

use double_pendulum::form::Direction;
use double_pendulum::plan::{Plan, Problem, Way, WayStepper};
use double_pendulum::{Error, Motion, Parameters};
use firmware::config::HALF_PIXEL;

use crate::oracle::reference::Reference;

/// The directions of both rods.
pub type Directions = [Direction<f64>; 2];

/// What became of a plan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Verdict {
    /// The last time until which every frame was right to half a pixel, s; the scene's duration if all were.
    pub horizon: f64,
    /// The largest error until the horizon that was promised, pixels.
    pub error: f64,
}

/// Carries out `plan` and compares each frame with the exact motion, until one is wrong and the promise is over.
///
/// The reference is given the scene's own numbers, the plan those that its arithmetic can hold.
pub fn judge(scene: &Problem, plan: &Plan) -> Result<Verdict, Error> {
    let way = Way { method: plan.method, steps: plan.steps };
    let mut motion = WayStepper::new(&scene.pendulum, &scene.start, scene.rate, way)?;
    let mut reference = Reference::new(&scene.pendulum, &scene.start);
    let mut verdict = Verdict { horizon: scene.duration, error: 0.0 };
    let mut right = true;
    for frame in 1..=scene.frames() {
        let time = scene.time(frame);
        let promised = time <= plan.horizon;
        if !right && !promised {
            break;
        }
        reference.advance_to(time);
        let Motion { a1, a2, .. } = reference.motion();
        motion.advance();
        let shown = motion.directions().map(|direction| direction.map(f64::from));
        let error = distance(scene, &shown, &[a1, a2].map(|a| [libm::sin(a), libm::cos(a)]));
        if promised {
            verdict.error = verdict.error.max(error);
        }
        if right && error > f64::from(HALF_PIXEL) {
            right = false;
            verdict.horizon = scene.time(frame - 1);
        }
    }
    Ok(verdict)
}

/// How far two references of this scene come apart that stop at other times, and so take other steps with other
/// roundings, pixels: what the judge itself may be wrong by. Until `seconds`.
pub fn reference_error(scene: &Problem, seconds: f64) -> f64 {
    let [mut one, mut other] = [(); 2].map(|()| Reference::new(&scene.pendulum, &scene.start));
    let Parameters { l1, l2, .. } = scene.pendulum;
    let mut worst: f64 = 0.0;
    for frame in 1..=scene.frames() {
        let [before, time] = [frame - 1, frame].map(|frame| scene.time(frame));
        if time > seconds {
            break;
        }
        other.advance_to(before + (time - before) / 3.0);
        let [one, other] = [&mut one, &mut other].map(|reference| {
            reference.advance_to(time);
            reference.exact_state()
        });
        let [elbow, rod] = [0, 1].map(|rod| f64::from(one[rod] - other[rod]).abs());
        worst = worst.max(scale(scene) * (l1 * elbow + l2 * rod));
    }
    worst
}

/// Pixels to a metre.
fn scale(scene: &Problem) -> f64 {
    f64::from(HALF_PIXEL) / scene.tolerance
}

/// How far the farther of the two bobs is off, pixels; infinite if anything is not a number.
pub fn distance(scene: &Problem, shown: &Directions, exact: &Directions) -> f64 {
    let Parameters { l1, l2, .. } = scene.pendulum;
    let scale = scale(scene);
    let off = |length: f64, rod: usize| [0, 1].map(|axis| scale * length * (shown[rod][axis] - exact[rod][axis]));
    let ([x1, y1], [x2, y2]) = (off(l1, 0), off(l2, 1));
    let (elbow, tip) = (x1.hypot(y1), (x1 + x2).hypot(y1 + y2));
    if elbow.is_finite() && tip.is_finite() { elbow.max(tip) } else { f64::INFINITY }
}
