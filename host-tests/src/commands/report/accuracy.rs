//! Errors against the reference, computed on the host: the bits are those of the target (see `identity`).

use std::f64::consts::TAU;

use double_pendulum::Motion;
use firmware::job::{JobError, Request, Row};

use super::scene::{SAMPLES, SCENES, Scene};
use super::{compared_rows, parallel};
use crate::oracle::reference::Reference;

/// The largest error over a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Of an angle, rad, whole turns apart.
    pub angle: f64,
    /// Of a bob's place on the panel, pixels.
    pub pixels: f64,
}

impl Error {
    /// Of a motion that has left the finite numbers.
    const LOST: Self = Self { angle: f64::INFINITY, pixels: f64::INFINITY };
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

/// The request for `row` through `scene` with steps of 2^-`halvings` s, at least 4 halvings.
pub fn request(row: Row, scene: &Scene, halvings: u32) -> Request {
    Request {
        row,
        parameters: scene.parameters(),
        angles: scene.angles(),
        velocities: [0.0; 2],
        dt: 0.5_f64.powi(halvings as i32),
        stride: (scene.duration << halvings) / SAMPLES,
        samples: SAMPLES,
    }
}

/// The error of `row`; `None` if it does not apply to the scene or the step. A motion that was lost has an infinite error.
pub fn error(row: Row, scene: &Scene, halvings: u32, exact: &[[f64; 2]]) -> Option<Error> {
    let mut angles = Vec::new();
    let run = request(row, scene, halvings).readings(|reading| {
        let [a1, a2, ..] = reading.state;
        angles.push([a1, a2]);
        Ok::<_, JobError>(())
    });
    match (run, &angles[..]) {
        (Ok(()), [_start, angles @ ..]) => Some(worst(scene, angles, exact)),
        (Err(JobError::Refused(double_pendulum::Error::Diverged { .. })), _) => Some(Error::LOST),
        _ => None,
    }
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
    pub row: Row,
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
        for row in compared_rows() {
            for halvings in halvings.clone() {
                let error = error(row, scene, halvings, &exact);
                points.extend(error.map(|error| Point { scene, row, halvings, error }));
                tick();
            }
        }
        points
    };
    let scenes: Vec<_> = SCENES.iter().take(scenes).collect();
    parallel(&scenes, |scene| through(scene)).concat()
}
