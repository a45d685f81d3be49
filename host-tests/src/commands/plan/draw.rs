//! Scenes of all kinds, drawn by a seed.

use std::f64::consts::PI;
use std::ops::Range;

use double_pendulum::plan::Problem;
use double_pendulum::{Motion, Parameters};
use fastrand::Rng;
use firmware::config::GRAVITY;
use firmware::motion::half_pixel;

use crate::oracle::random::{log_uniform, symmetric};

/// The height of the display, pixels: half of one may be missed.
pub const HEIGHT: f64 = 64.0;
pub const RATE: u16 = 60;
/// The length of rod 1, m: with gravity given, too, the mass and length ratios are all there is.
const ROD: f64 = 1.0;
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
    let mass_ratio = log_uniform(rng, 1e-3, 1e3);
    let length_ratio = log_uniform(rng, 1e-2, 1e2);
    let pendulum = Parameters { m1: 1.0, m2: mass_ratio, l1: ROD, l2: ROD * length_ratio, g: GRAVITY };
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

/// From [`LEAST`] to `most`.
fn size(rng: &mut Rng, most: f64) -> f64 {
    if rng.bool() { log_uniform(rng, LEAST, most) } else { LEAST + (most - LEAST) * rng.f64() }
}
