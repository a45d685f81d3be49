//! Errors against the reference, computed on the host: the bits are those of the target (see `identity`).

use std::f64::consts::TAU;

use double_pendulum::{Motion, State};
use firmware::measure::{Request, SUBJECTS, Subject};

use super::parallel;
use super::scene::{SAMPLES, SCENES, Scene};
use crate::oracle::reference::Reference;

/// The largest error over a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Of an angle, rad, whole turns apart.
    pub angle: f64,
    /// Of a bob's place on the panel, pixels.
    pub pixels: f64,
}

/// The exact motion through a scene's samples: a1, a2.
pub fn exact(scene: &Scene) -> Vec<[f64; 2]> {
    let [a1, a2] = scene.angles();
    let mut reference = Reference::new(&scene.parameters(), &Motion::at_rest(a1, a2));
    let times = (1..=SAMPLES).map(|sample| f64::from(sample * scene.duration) / f64::from(SAMPLES));
    times
        .map(|time| {
            reference.advance_to(time);
            let Motion { a1, a2, .. } = reference.motion();
            [a1, a2]
        })
        .collect()
}

/// The request for `subject` through `scene` with steps of 2^-`halvings` s, at least 4 halvings.
pub fn request<'a>(subject: &'a Subject, scene: &Scene, halvings: u32) -> Request<'a> {
    Request {
        subject: subject.name,
        samples: SAMPLES,
        steps: (scene.duration << halvings) / SAMPLES,
        parameters: scene.parameters(),
        angles: scene.angles(),
        dt: 0.5_f64.powi(halvings as i32),
    }
}

/// The error of `subject`; `None` if it does not apply to the scene. A motion that was lost has an infinite error.
pub fn error(subject: &Subject, scene: &Scene, halvings: u32, exact: &[[f64; 2]]) -> Option<Error> {
    let mut states = Vec::new();
    request(subject, scene, halvings).run(&mut |state: &State<f64>| states.push([state.a1, state.a2])).ok()?;
    Some(worst(scene, &states, exact))
}

/// The largest error of the angles a1, a2 at the scene's samples.
pub fn worst(scene: &Scene, angles: &[[f64; 2]], exact: &[[f64; 2]]) -> Error {
    let mut worst = Error { angle: 0.0, pixels: 0.0 };
    for (&angles, &exact) in angles.iter().zip(exact) {
        let angle = apart(angles[0], exact[0]).max(apart(angles[1], exact[1]));
        worst.angle = worst.angle.max(angle);
        worst.pixels = worst.pixels.max(pixels(scene, angles, exact));
    }
    worst
}

/// How far apart two angles point, rad, at most pi: the direction form knows no whole turns. Infinite if one is no number.
fn apart(angle: f64, exact: f64) -> f64 {
    let turns = (angle - exact) / TAU;
    let apart = (turns - turns.round()).abs() * TAU;
    if apart.is_finite() { apart } else { f64::INFINITY }
}

/// The larger distance on the panel between where the bobs are drawn and where they belong.
fn pixels(scene: &Scene, angles: [f64; 2], exact: [f64; 2]) -> f64 {
    let parameters = scene.parameters();
    let places = |[a1, a2]: [f64; 2]| {
        let elbow = [parameters.l1 * libm::sin(a1), -parameters.l1 * libm::cos(a1)];
        [elbow, [elbow[0] + parameters.l2 * libm::sin(a2), elbow[1] - parameters.l2 * libm::cos(a2)]]
    };
    let (drawn, right) = (places(angles), places(exact));
    let distance = |bob: usize| libm::hypot(drawn[bob][0] - right[bob][0], drawn[bob][1] - right[bob][1]);
    let metres = distance(0).max(distance(1));
    if metres.is_finite() { scene.scale() * metres } else { f64::INFINITY }
}

/// One arithmetic, one scene, one step size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The scene.
    pub scene: &'static Scene,
    /// The arithmetic.
    pub subject: &'static Subject,
    /// The step is 2^-`halvings` s.
    pub halvings: u32,
    /// The largest error over the scene.
    pub error: Error,
}

/// Every arithmetic on the first `scenes` scenes with every step size in `halvings`, the scenes on threads of their own;
/// `tick` is called after each run.
pub fn survey(
    scenes: usize,
    halvings: impl Iterator<Item = u32> + Clone + Sync,
    tick: &(dyn Fn() + Sync),
) -> Vec<Point> {
    let through = |scene: &'static Scene| {
        let exact = exact(scene);
        let mut points = Vec::new();
        for subject in SUBJECTS {
            for halvings in halvings.clone() {
                let error = error(subject, scene, halvings, &exact);
                points.extend(error.map(|error| Point { scene, subject, halvings, error }));
                tick();
            }
        }
        points
    };
    let scenes: Vec<_> = SCENES.iter().take(scenes).collect();
    parallel(&scenes, |scene| through(scene)).concat()
}
