//! Errors against the reference through the motions that the report measures on, computed on the host: the bits are those of
//! the target (see `identity`).

use double_pendulum::{Method, Motion, Parameters, Pendulum, State};
use firmware::config::{GRAVITY, REACH};
use firmware::job::Request;

use crate::oracle::trials::apart;
use reference::taylor;

/// Equal rods and bobs from rest. Every number is one that an `f32` holds, so that all arithmetics are given the same pendulum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    pub name: &'static str,
    /// Both angles at the start, rad.
    pub angle: f64,
    /// How long it is followed, whole seconds: short where neighbouring motions part quickly.
    pub duration: u32,
}

/// The most states that are compared with the reference in each second.
pub const SAMPLES: u32 = 4;

/// A regular and a chaotic one.
pub const SCENES: [Scene; 2] = [
    Scene {
        name: "regular",
        angle: 0.5,
        duration: 10,
    },
    Scene {
        name: "chaotic",
        angle: 2.0,
        duration: 5,
    },
];
/// The regular motion for ten times as long.
pub const LONG: Scene = Scene {
    name: "regular-long",
    angle: 0.5,
    duration: 100,
};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Of an angle, rad, whole turns apart.
    pub angle: f64,
    /// Of a bob's place on the panel, pixels.
    pub pixels: f64,
}

/// Of a motion that has left the finite numbers.
const LOST: Error = Error {
    angle: f64::INFINITY,
    pixels: f64::INFINITY,
};

/// The exact motion, a1 and a2, after each of `steps` equal steps through a scene.
pub fn exact(scene: &Scene, steps: u32) -> Vec<[f64; 2]> {
    let Request {
        parameters,
        angles: [a1, a2],
        ..
    } = request(Method::Rk4F64, scene, 1);
    let times = (1..=steps).map(|step| f64::from(step * scene.duration) / f64::from(steps));
    taylor::states(&parameters, &Motion::at_rest(a1, a2), times)
        .iter()
        .map(State::angles)
        .collect()
}

/// How many states of a motion with `rate` steps a second are compared in each: as many as fall on whole steps.
fn samples(rate: u32) -> u32 {
    [SAMPLES, SAMPLES / 2]
        .into_iter()
        .find(|samples| rate.is_multiple_of(*samples))
        .unwrap_or(1)
}

/// The request for `method` through `scene` with `rate` steps a second.
pub fn request(method: Method, scene: &Scene, rate: u32) -> Request {
    Request {
        method,
        parameters: Parameters::equal_rods(1.0, 1.0, (GRAVITY as f32).into()),
        angles: [scene.angle; 2],
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
const HIGH: [u32; 21] = [
    4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 18, 20, 24, 28, 32, 40, 48, 64, 80, 96,
];
const LOW: [u32; 3] = [16, 32, 64];

/// Steps a second that `method` is tried with through a scene: a few, and all powers of two beyond; through the long one as many as
/// are usual.
pub fn rates(method: Method, scene: &Scene, finest: u32) -> impl Iterator<Item = u32> {
    let few: &[u32] = if method.order() > 4 { &HIGH } else { &LOW };
    let all = few
        .iter()
        .copied()
        .chain((7..=finest).map(|halvings| 1 << halvings));
    all.filter(move |&rate| scene != &LONG || rate == usual_rate(method))
}

/// The error of `method` in `steps` equal steps through the scene, compared after each; a second need not be a whole number of them.
pub fn error_after(method: Method, scene: &Scene, steps: u32) -> Option<Error> {
    let dt = f64::from(scene.duration) / f64::from(steps);
    let request = Request {
        dt,
        stride: 1,
        samples: steps,
        ..request(method, scene, 1)
    };
    error(&request, &exact(scene, steps))
}

/// The error of a request; `None` if its method does not apply to the scene or the step. A motion that was lost has an infinite one.
pub fn error(request: &Request, exact: &[[f64; 2]]) -> Option<Error> {
    let mut angles = Vec::new();
    let run = request.readings::<double_pendulum::Error>(|reading| {
        angles.push([reading.state[0], reading.state[1]]);
        Ok(())
    });
    match (run, &angles[..]) {
        (Ok(()), [_start, angles @ ..]) => Some(worst(&request.parameters, angles, exact)),
        (Err(double_pendulum::Error::Diverged { .. }), _) => Some(LOST),
        _ => None,
    }
}

/// The largest error of the angles a1, a2, at as many moments of the scene as there are; `exact` has them and more.
pub fn worst(parameters: &Parameters<f64>, angles: &[[f64; 2]], exact: &[[f64; 2]]) -> Error {
    let Ok(pendulum) = Pendulum::new(parameters) else {
        return LOST;
    };
    let scale = f64::from(REACH) / (parameters.l1 + parameters.l2);
    let mut worst = Error {
        angle: 0.0,
        pixels: 0.0,
    };
    let apart_by = (exact.len() / angles.len().max(1)).max(1);
    for (&angles, &exact) in angles
        .iter()
        .zip(exact.iter().skip(apart_by - 1).step_by(apart_by))
    {
        let angle = apart(angles[0], exact[0]).max(apart(angles[1], exact[1]));
        worst.angle = worst.angle.max(angle);
        let [drawn, right] = [angles, exact].map(|angles| pendulum.positions(angles));
        let off =
            |bob: usize| libm::hypot(drawn[bob].x - right[bob].x, drawn[bob].y - right[bob].y);
        let pixels = scale * off(0).max(off(1));
        worst.pixels = worst.pixels.max(if angle.is_finite() {
            pixels
        } else {
            f64::INFINITY
        });
    }
    worst
}
