//! The errors of methods in the report's motions, compared with the reference. They are computed on
//! the host, which computes the same bits as the target (test `identity`).

use double_pendulum::{Method, Motion, Parameters, Pendulum, State};
use firmware::config::{GRAVITY, REACH};
use firmware::job::Request;

use exact::taylor;
use exact::trials::apart;

/// A motion of equal rods (1 m) and bobs (1 kg) from rest, at 9.81 m/s^2. No
/// `f32` is 9.81: an error includes that a method rounds the numbers that a user types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportedMotion {
    pub name: &'static str,
    pub angle: f64,
    /// Whole seconds. It is short if neighbouring motions separate quickly.
    pub duration: u32,
}

pub const SAMPLES: u32 = 4;

pub const SCENES: [ReportedMotion; 2] = [
    ReportedMotion {
        name: "regular",
        angle: 0.5,
        duration: 10,
    },
    ReportedMotion {
        name: "chaotic",
        angle: 2.0,
        duration: 5,
    },
];
pub const LONG: ReportedMotion = ReportedMotion {
    name: "regular-long",
    angle: 0.5,
    duration: 100,
};

/// The largest errors of a motion at the compared moments. Both are infinite if the motion has
/// diverged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// Of an angle, rad, without whole turns.
    pub angle: f64,
    /// Of a bob on the panel, pixels.
    pub pixels: f64,
}

const LOST: Error = Error {
    angle: f64::INFINITY,
    pixels: f64::INFINITY,
};

/// Returns the angles of the exact motion after each of `steps` equal steps through a scene.
pub fn exact(scene: &ReportedMotion, steps: u32) -> Vec<[f64; 2]> {
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

/// The largest number of states that fall on whole steps.
fn samples(rate: u32) -> u32 {
    [SAMPLES, SAMPLES / 2]
        .into_iter()
        .find(|samples| rate.is_multiple_of(*samples))
        .unwrap_or(1)
}

/// Requests [`SAMPLES`] states per second, or fewer if these do not fall on whole steps.
pub fn request(method: Method, scene: &ReportedMotion, rate: u32) -> Request {
    Request {
        method,
        parameters: Parameters::equal_rods(1.0, 1.0, GRAVITY),
        angles: [scene.angle; 2],
        velocities: [0.0; 2],
        dt: 1.0 / f64::from(rate),
        stride: rate / samples(rate),
        samples: samples(rate) * scene.duration,
    }
}

/// Returns a typical number of steps per simulated second.
pub fn usual_rate(method: Method) -> u32 {
    if method.order() > 4 { 16 } else { 256 }
}

const HIGH: [u32; 21] = [
    4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 18, 20, 24, 28, 32, 40, 48, 64, 80, 96,
];
const LOW: [u32; 3] = [16, 32, 64];

/// Returns the numbers of steps a second to try with `method` in a scene, ascending.
pub fn rates(method: Method, scene: &ReportedMotion, finest: u32) -> impl Iterator<Item = u32> {
    let few: &[u32] = if method.order() > 4 { &HIGH } else { &LOW };
    let all = few
        .iter()
        .copied()
        .chain((7..=finest).map(|halvings| 1 << halvings));
    all.filter(move |&rate| scene != &LONG || rate == usual_rate(method))
}

/// Returns the error of `method` in `steps` equal steps through the scene.
pub fn error_after(method: Method, scene: &ReportedMotion, steps: u32) -> Option<Error> {
    let dt = f64::from(scene.duration) / f64::from(steps);
    let request = Request {
        dt,
        stride: 1,
        samples: steps,
        ..request(method, scene, 1)
    };
    error(&request, &exact(scene, steps))
}

/// Returns the error of a request at its samples after the start; `None` if its method does not
/// support the scene or the step.
pub fn error(request: &Request, exact: &[[f64; 2]]) -> Option<Error> {
    let mut angles = Vec::new();
    let run = request.readings::<double_pendulum::Error>(|reading| {
        angles.push([reading.state[0], reading.state[1]]);
        Ok(())
    });
    match (run, &angles[..]) {
        // The first reading is the start, which has no error.
        (Ok(()), [_start, angles @ ..]) => Some(worst(&request.parameters, angles, exact)),
        (Err(double_pendulum::Error::Diverged { .. }), _) => Some(LOST),
        _ => None,
    }
}

/// Returns the largest errors. `exact` may have more moments than `angles`, equally often between
/// them.
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
        // A motion that has left the finite numbers is infinitely far away.
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
