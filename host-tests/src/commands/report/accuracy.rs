//! Errors against the reference, computed on the host: the bits are those of the target (see `identity`).

use double_pendulum::{Method, Motion, Pendulum, State};
use firmware::job::{JobError, Request};

use super::scene::{SAMPLES, Scene};
use crate::oracle::trials::apart;
use reference::taylor;

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

/// The exact motion through a scene, [`SAMPLES`] times a second: a1, a2.
pub fn exact(scene: &Scene) -> Vec<[f64; 2]> {
    exact_after(scene, SAMPLES * scene.duration)
}

/// The exact motion after each of `steps` equal steps through a scene.
fn exact_after(scene: &Scene, steps: u32) -> Vec<[f64; 2]> {
    let [a1, a2] = scene.angles();
    let times: Vec<_> = (1..=steps).map(|step| f64::from(step * scene.duration) / f64::from(steps)).collect();
    let states = taylor::states(&scene.parameters(), &Motion::at_rest(a1, a2), &times);
    states.iter().map(State::angles).collect()
}

/// How many states of a motion with `rate` steps a second are compared in each: as many as fall on whole steps.
fn samples(rate: u32) -> u32 {
    [SAMPLES, SAMPLES / 2].into_iter().find(|samples| rate.is_multiple_of(*samples)).unwrap_or(1)
}

/// The request for `method` through `scene` with `rate` steps a second.
pub fn request(method: Method, scene: &Scene, rate: u32) -> Request {
    Request {
        method,
        parameters: scene.parameters(),
        angles: scene.angles(),
        velocities: [0.0; 2],
        dt: 1.0 / f64::from(rate),
        stride: rate / samples(rate),
        samples: samples(rate) * scene.duration,
    }
}

/// Steps a second that are fair to count and to show: many for a low order, few for a high one.
pub fn usual_rate(method: Method) -> u32 {
    if method.order() > 4 { 16 } else { 256 }
}

/// A few steps a second, for high orders and for low ones.
const HIGH: [u32; 21] = [4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 18, 20, 24, 28, 32, 40, 48, 64, 80, 96];
const LOW: [u32; 3] = [16, 32, 64];

/// Steps a second that `method` is tried with: a few, and all powers of two beyond.
pub fn rates(method: Method, finest: u32) -> impl Iterator<Item = u32> + Clone {
    let few: &[u32] = if method.order() > 4 { &HIGH } else { &LOW };
    few.iter().copied().chain((7..=finest).map(|halvings| 1 << halvings))
}

/// The error of `method`; `None` if it does not apply to the scene or the step. A motion that was lost has an infinite error.
pub fn error(method: Method, scene: &Scene, rate: u32, exact: &[[f64; 2]]) -> Option<Error> {
    error_of(&request(method, scene, rate), scene, exact)
}

/// The error of `method` in `steps` equal steps through the scene, compared after each; a second need not be a whole number of them.
pub fn error_after(method: Method, scene: &Scene, steps: u32) -> Option<Error> {
    let dt = f64::from(scene.duration) / f64::from(steps);
    let request = Request { dt, stride: 1, samples: steps, ..request(method, scene, 1) };
    error_of(&request, scene, &exact_after(scene, steps))
}

fn error_of(request: &Request, scene: &Scene, exact: &[[f64; 2]]) -> Option<Error> {
    let mut angles = Vec::new();
    let run = request.readings(|reading| {
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

/// The largest error of the angles a1, a2, at as many moments of the scene as there are; `exact` has them and more.
pub fn worst(scene: &Scene, angles: &[[f64; 2]], exact: &[[f64; 2]]) -> Error {
    let Ok(pendulum) = Pendulum::new(&scene.parameters()) else { return Error::LOST };
    let mut worst = Error { angle: 0.0, pixels: 0.0 };
    let apart_by = (exact.len() / angles.len().max(1)).max(1);
    for (&angles, &exact) in angles.iter().zip(exact.iter().skip(apart_by - 1).step_by(apart_by)) {
        let angle = apart(angles[0], exact[0]).max(apart(angles[1], exact[1]));
        worst.angle = worst.angle.max(angle);
        let [drawn, right] = [angles, exact].map(|angles| pendulum.positions(angles));
        let off = |bob: usize| libm::hypot(drawn[bob].x - right[bob].x, drawn[bob].y - right[bob].y);
        let pixels = scene.scale() * off(0).max(off(1));
        worst.pixels = worst.pixels.max(if angle.is_finite() { pixels } else { f64::INFINITY });
    }
    worst
}
