//! The errors of methods in the report's motions, compared with the reference. They are computed on
//! the host, which computes the same bits as the target (test `identity`).

use double_pendulum::{Method, Motion, Parameters, Pendulum, State};
use firmware::config::{GRAVITY, REACH};
use firmware::job::Request;

use crate::oracle::trials::apart;
use reference::taylor;

/// A motion of equal rods (1 m) and bobs (1 kg) from rest, at 9.81 m/s^2 rounded to `f32`. Every
/// number can be represented in `f32`, so that all arithmetics compute the same pendulum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    /// The name in tables and files.
    pub name: &'static str,
    /// The angle of both rods at the start, rad.
    pub angle: f64,
    /// The duration, whole seconds. It is short if neighbouring motions separate quickly.
    pub duration: u32,
}

/// The largest number of states that are compared with the reference in each second.
pub const SAMPLES: u32 = 4;

/// The regular motion from 0.5 rad for 10 s, named "regular", and a chaotic one from 2 rad for 5 s,
/// named "chaotic".
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
/// The regular motion from 0.5 rad for ten times as long, 100 s, named "regular-long".
pub const LONG: Scene = Scene {
    name: "regular-long",
    angle: 0.5,
    duration: 100,
};

/// The largest errors of a motion at the compared moments, of both rods and both bobs; 0 if no
/// moment is compared. Both are infinite if the motion has diverged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Error {
    /// The error of an angle, rad, 0 or more, without whole turns: at most pi.
    pub angle: f64,
    /// The distance of a bob from its exact position on the panel, pixels. Both rods together are
    /// [`REACH`] long there, 28.5 pixels.
    pub pixels: f64,
}

/// The error of a motion that has diverged.
const LOST: Error = Error {
    angle: f64::INFINITY,
    pixels: f64::INFINITY,
};

/// Returns the angles a1 and a2 of the exact motion after each of `steps` equal steps through a
/// scene, by the reference, rounded to `f64`. The start is not among them. Angles are in rad, with
/// their whole turns. 0 steps give an empty list. Not checked: `steps` times the duration must be
/// less than 2^32.
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

/// Returns the number of states that are compared in each second of a motion with `rate` steps a
/// second: the largest that fall on whole steps.
fn samples(rate: u32) -> u32 {
    [SAMPLES, SAMPLES / 2]
        .into_iter()
        .find(|samples| rate.is_multiple_of(*samples))
        .unwrap_or(1)
}

/// Returns the request for `method` through `scene` with `rate` steps a second, at least 1, which
/// is not checked. It requests [`SAMPLES`] states per second, or 2 or 1 if these do not fall on
/// whole steps.
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

/// Returns a typical number of steps per simulated second, for counts and displays: 16 for an order
/// above 4, 256 for others, also for the closed forms.
pub fn usual_rate(method: Method) -> u32 {
    if method.order() > 4 { 16 } else { 256 }
}

/// Small numbers of steps a second, for high and low orders.
const HIGH: [u32; 21] = [
    4, 5, 6, 7, 8, 9, 10, 11, 12, 14, 16, 18, 20, 24, 28, 32, 40, 48, 64, 80, 96,
];
const LOW: [u32; 3] = [16, 32, 64];

/// Returns the numbers of steps a second to try with `method` in a scene, ascending. The first ones
/// are 21 numbers from 4 to 96 for an order above 4, and 16, 32 and 64 for any other order. All
/// powers of two from 2^7 to 2^`finest` follow for every order, none if `finest` is less than 7. Of
/// these, [`LONG`] is tried with [`usual_rate`] only. Not checked: `finest` is at most 31.
pub fn rates(method: Method, scene: &Scene, finest: u32) -> impl Iterator<Item = u32> {
    let few: &[u32] = if method.order() > 4 { &HIGH } else { &LOW };
    let all = few
        .iter()
        .copied()
        .chain((7..=finest).map(|halvings| 1 << halvings));
    all.filter(move |&rate| scene != &LONG || rate == usual_rate(method))
}

/// Returns the error of `method` in `steps` equal steps through the scene, compared after each
/// step, or `None` as in [`error`]. A second need not be a whole number of steps. 0 steps give
/// `None`. The largest number of steps is that of [`exact`].
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

/// Returns the error of a request at its samples after the start, or `None` if its method does not
/// support the scene or the step. A motion that has diverged has an infinite error. `exact` has the
/// angles of these samples, as in [`worst`].
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

/// Returns the largest error, in rad and pixels of the panel, of both angles and of both bobs at
/// all moments of `angles` (a1, a2 in rad). `exact` has the angles of these moments and possibly,
/// equally often, of moments between them; its length is a multiple of that of `angles`, which is
/// not checked. The error of an angle is without whole turns, at most pi.
///
/// The errors are infinite if a compared angle is not finite or if the kernel refuses the
/// parameters. Otherwise, if one of the lists is empty, they are 0. With an `exact` that is shorter
/// than `angles`, only its moments are compared.
pub fn worst(parameters: &Parameters<f64>, angles: &[[f64; 2]], exact: &[[f64; 2]]) -> Error {
    let Ok(pendulum) = Pendulum::new(parameters) else {
        return LOST;
    };
    let scale = f64::from(REACH) / (parameters.l1 + parameters.l2);
    // The reference may have more moments than the method. Every `apart_by`-th one is compared.
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
