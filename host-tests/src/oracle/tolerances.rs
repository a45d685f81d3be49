//! Budgets: how far a number may be off in a test, and why just so far. That of one motion stands with the motion.

use double_pendulum::{Method, Numbers, Parameters, State};
use reference::enclosure::fastest_rate;

use crate::oracle::known_answers::KnownAnswer;

#[path = "../../../kernel/src/tests/tolerances.rs"]
mod shared;
pub use shared::*;

impl PerPrecision {
    /// The budget for a method in 32 bits or in 64.
    pub fn by(&self, method: Method) -> f64 {
        if method.is_single() || method.numbers() == Numbers::Fixed32 {
            self.single
        } else {
            self.double
        }
    }
}

/// Normal frequencies, fast and slow, mode shapes and the exchange frequency, in units in the last place: nine roundings, halved by
/// the square root, and up to ten roundings.
pub const MODES: [f64; 5] = [4.0, 4.0, 10.0, 10.0, 10.0];

/// Linear against exact motion at 1e-6 rad, relative to the amplitude: the neglected cubic term, 1e-12, times the
/// radians swung in the ten seconds (up to 200).
pub const LINEAR: f64 = 1e-9;

/// Bounds along a motion by RK4 with 0.05 rad per step: its energy error over 100 steps (measured: no excess at all).
pub const BOUNDS_DRIFT: f64 = 1e-6;

/// What one admissible step may miss, over (fastest rate) dt: rad in an angle, and the fastest rate's share in a velocity.
/// Classical step and direction form; measured, for the worst motions that a search found over masses 1e-6..1e6
/// and lengths 1:100..100:1: 2.8e-5 and 7.7e-5.
pub const ADMISSIBLE: [f64; 2] = [3e-5, 8e-5];

/// The reference outside what is proved of the motion, to be multiplied by the growth of a small error: the roundings (1e-32) of some
/// hundred steps of double-double arithmetic (measured: within 3e-32, and within all digits of the table of known answers).
pub const REFERENCE: f64 = 1e-31;

/// How wide the enclosure of a direction is, in growths of a small error (measured: 2.3e-28 at most).
pub const ENCLOSURE: f64 = 1e-27;

/// The misprinted form's mean energy at figure 7, J, about -18.7: what 32 chaotic runs of 100 s differ by (measured -18.3
/// over 0..100 s, -18.9 over 5..100 s, falling on in longer runs).
pub const MISPRINT_ENERGY: f64 = 2.0;

/// The share of its time that the misprinted form's bob 2 may be above the pivot (measured 8.4 %).
pub const MISPRINT_ABOVE: f64 = 0.12;

/// What the energy shown of the misprinted form may be off by in the first 5 s, J (measured 0.15, where rod 2 is quickest).
pub const MISPRINT_SHOWN: f64 = 0.3;

/// Energies that the misprinted form passes through at figure 7 in 10 s, J, from 62.9 at the start (measured -45 to 63.1):
/// it does not keep the energy.
pub const MISPRINT_SWING: [f64; 2] = [-40.0, 60.0];

/// Half of the last digit of 62.9 J.
pub const LAST_DIGIT_OF_62_9: f64 = 0.05;

/// The right form's energy error at figure 7 with 512 steps per second for 100 s, J (measured 2.4e-3 of 127).
pub const FIGURE_7_ENERGY: f64 = 0.01;

/// The right form's share above the pivot, about 50.7 %: what 32 chaotic runs of 100 s differ by (measured 52.0 %).
pub const FIGURE_7_ABOVE: f64 = 0.03;

/// A method against a known answer: growth of a small error times the errors made on the way by plain RK4 in 4096 steps a second,
/// which no other exceeds.
///
/// - Truncation: RK4 misses an oscillation of rate W by (W dt)^5/120 in each step, W being the larger of the fast normal
///   frequency and the greatest angular velocity the energy allows: W^5 dt^4 t/120 in all.
/// - Rounding: each step rounds angles of size A by A epsilon/2 at most, n steps walk at random to A epsilon sqrt(n),
///   doubled because increments near rest are rounded alike; A is 4 (pi, up to its binade) or the exact angle.
/// - Evaluation: the velocities are off by epsilon W sqrt((m1 + m2)/m1), because w1 is a difference of momenta that are
///   this much larger; as large is the change of all rates by the rounding of the parameters.
///
/// Beyond the horizon of trust it exceeds 1 and claims nothing; [`KNOWN_ANSWERS_CLAIMED`] counts the rows before it.
pub fn known_answer(row: &KnownAnswer, method: Method, &State { a1, a2, .. }: &State<f64>) -> f64 {
    const STEPS_PER_SECOND: f64 = 4096.0;
    let rate = fastest_rate(&row.parameters, &row.start.motion());
    let epsilon = PerPrecision {
        single: f32::EPSILON.into(),
        double: f64::EPSILON,
    }
    .by(method);
    let truncation = rate.powi(5) / STEPS_PER_SECOND.powi(4) * row.time / 120.0;
    let angle = a1.abs().max(a2.abs()).max(4.0);
    let rounding = angle * epsilon * (row.time * STEPS_PER_SECOND).sqrt();
    let Parameters { m1, m2, .. } = row.parameters;
    let evaluation = epsilon * rate * row.time * ((m1 + m2) / m1).sqrt();
    row.growth * (truncation + rounding + evaluation)
}

/// How many rows of the table must have a budget below 1, so that the test says something: the rest is chaos.
pub const KNOWN_ANSWERS_CLAIMED: PerPrecision = PerPrecision {
    single: 36.0,
    double: 45.0,
};

/// The growth about the inverted rest in 1 s from a push of 1e-10 rad, relative: what the cubic term and the other mode,
/// excited by the rounding of the shape, add.
pub const INVERTED_GROWTH: f64 = 1e-9;

/// By how much of itself a step may be longer than dt, epsilons: the unit of time by half of what gravity may be rounded.
pub const LONGER: f64 = 17.0;

/// When a pendulum that stood upright is a radian down, s: one look, and RK4's error of the growth rate at 2^-6 s.
pub const FALL: f64 = 1.5 / 64.0;

/// How long plain sums keep a pendulum upright, relative: the step in which they no longer do, and the rounding of w.
pub const STAYS: f64 = 0.05;

/// A swing of 1e-5 rad after 200 steps 2 % below and above the limit of stability, rad: decayed and grown at
/// least ten times (measured: to 6e-12 at most, to 7e-4 at least).
pub const STABILITY_EDGE: [f64; 2] = [1e-6, 1e-4];

/// Directions against the angles of the same motion, in epsilons: roundings of the sines and the lengths.
pub const DIRECTIONS: f64 = 8.0;
/// Their lengths against 1 with 64 steps a second: what restoring them to first order leaves (measured 3e-6).
pub const LENGTHS: f64 = 1e-5;

/// At rest for 10,000 steps in 64 bits of fixed point, rad and kg m^2/s: half of a last digit in each (measured 2.6e-13).
pub const REST_OF_FIXED_64: f64 = 1e-12;

/// Straight rods turning evenly without gravity, 20 s, rad and relative: in f32 some 5000 steps of plain sums, each
/// rounded; in f64 the direction form's own error, 6e-11 rad a second at 2 rad/s.
pub const STRAIGHT: PerPrecision = PerPrecision {
    single: 1e-3,
    double: 2e-9,
};

/// A tiny swing against the cosine, relative, 10 s: the roundings of 2560 plain sums; RK4's own error is 1e-9.
pub const TINY: PerPrecision = PerPrecision {
    single: 1e-3,
    double: 1e-8,
};

/// A million compensated steps of 2^-13 s of regular motion, rad (measured 2e-7 and
/// 9e-14; plain sums miss 2e-5 in f32).
pub const MILLION_STEPS: PerPrecision = PerPrecision {
    single: 5e-7,
    double: 3e-13,
};

/// How much better a compensated form is than a plain one on the regular scene in 10 s, at least (measured: 30 to 70).
pub const COMPENSATION_GAIN: f64 = 10.0;

/// A frequency or period read off a plotted curve where it crosses a level, relative: half of the last digit given of the
/// shortest, 1.3e-6, and the shift of a crossing by joining the points with straight lines, (w dt)^3/16 of a radian or
/// 2e-5 for the fastest curve, over the 23 rad shown at least.
pub const PLOTTED_FREQUENCY: f64 = 3e-6;
/// The greatest of a plotted curve's points, relative to that of the curve: between two points it is at most
/// (w dt/2)^2/2 higher, 4e-4 for the fastest envelope.
pub const PLOTTED_AMPLITUDE: f64 = 5e-4;

/// Figure 7's paths, m: a hundredth of the width of its lines (measured: 3e-6).
pub const FIGURE_7_PATH: f64 = 1e-4;

/// The error of a frame before the planner's predicted horizon, pixels, where it is more than half a pixel.
pub const PLAN_ERROR: f64 = 0.75;

/// The predicted over the true horizon, in the median of all scenes that cease to be right.
pub const PLAN_SHARE: f64 = 0.7;

/// The height that a scene of curves is planned for, relative: the digits of the swing in pixels, 21.5.
pub const SHOWN_HEIGHT: f32 = 1e-3;

/// What the linear beats miss after their period, of their amplitude: the same for up to five turns.
pub const CLOSED: f64 = 5.0 * f32::EPSILON as f64 * 2.0 * 5.0 * std::f64::consts::TAU;

/// How far the exact motion is then from its start at the least, pixels: farther than a line is wide.
pub const NOT_CLOSED: f64 = 1.0;

/// The floor of the 32-bit fixed point with steps so fine that the method errs less, regular for 10 s, rad (measured
/// 2e-9; compensated `f32` has 3e-8).
pub const FIXED_32_FLOOR: f64 = 5e-9;

/// What the order of 32 bits is measured by, rad: what roundings leave scatters from step to step, and is less in most of the
/// motions tried.
pub const FIXED_32_ORDER_MEASURABLE: f64 = 5e-6;

/// Chaotic, the 64-bit fixed point against `f64` at the same steps; where both are at their floors, the floor, rad.
pub const FIXED_64_AGAINST_DOUBLE: f64 = 2.0;
/// That floor: roundings of 2^-61, as often as weights of order 12 enlarge them, grow 2000-fold in these 5 s.
pub const FIXED_64_FLOOR: f64 = 1e-12;

/// How far a measured order of extrapolation may be off: with steps as coarse as high orders need to be above the roundings of a hundred
/// steps, which they enlarge, the next power of the step has its share (measured 5.98, 7.91, 12.34, 15.25); the next order is 2 off.
pub const ORDER_EXTRAPOLATED: f64 = 0.8;
/// Points of a map of flips with a limit of 10 sqrt(l/g) that are right to a grey level, of those that may turn over: the goal.
pub const FLIPS_RIGHT: f64 = 0.999;
/// With a limit of 100 sqrt(l/g) chaos leaves fewer: at most so many are wrong, ...
pub const FLIPS_WRONG: f64 = 0.04;
/// ... and so many of all are wrong without being in doubt.
pub const FLIPS_UNSUSPECTED: f64 = 0.01;

/// Three steps as coarse as there may be in 64-bit fixed point and in `f64`, rad.
pub const FIXED_64_AND_DOUBLE: f64 = 1e-9;

/// A second of a motion in which both rods turn over, in steps of 1/8192 s, by every row of the table: the method's error in
/// double precision, the roundings of single, and the sines of `micromath`.
pub const TURNING: [f64; 3] = [5e-7, 5e-3, 1.0];

/// A second of a motion of 2e-5 rad in closed form, rad and kg m^2/s: in double precision what is not linear and RK4's own error
/// (measured 1.8e-13), in single a few roundings (measured 1.4e-11).
pub const SMALL_MOTION: [f64; 2] = [3e-13, 2e-11];

/// The energy error of a frame, by the directions in 64 bits against by the angles: some roundings of
/// `f64`, of numbers three times as large as what it is relative to.
pub const ENERGY_SHOWN: f64 = 1e-14;

/// The energy of the misprinted motion in its first second or until it is lost, over twice the
/// largest potential energy: at large mass ratios it is wilder than any true motion, and rounding
/// shows within a second.
pub const MISPRINT_ENERGY_SHOWN: f64 = 0.1;

/// The energy along a day in 32 bits beside that of `f64` in the same steps, over the energy above rest: the goal (measured at
/// five mass ratios and three steps: compensated `f32` up to 2.0e-4, plain 3.1e-4, fixed point 2.6e-6).
pub const DAY_ENERGY: f64 = 1e-3;
/// What taking back up to half a step does to it, and the roundings of directions and momenta to `f32`: the goal.
pub const DAY_READING: f64 = 1e-4;
/// A second of 1024 steps there and back in 32 bits: what roundings leave where each is carried into the next (measured 8e-8), and
/// where it is dropped (measured 1.8e-6).
pub const RETURN_OF_32_BITS: [f64; 2] = [1e-7, 4e-6];

/// What a method's measured order may differ by, of itself: the next order has its share at the steps used, and of order 16 the
/// roundings (measured 3.73, 8.08, 10.04, 11.75 and 15.0); and that of RK4 in finer steps (measured 3.93 to 3.995).
pub const ORDER_OF_METHODS: [f64; 2] = [0.1, 0.025];
