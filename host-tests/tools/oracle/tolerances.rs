//! The tolerances of tests, with their reasons. The tolerance of a single motion is stored with the
//! motion. A constant that is called an error, a difference or a distance is the largest allowed
//! one. A relative one has no unit.

use double_pendulum::{Method, Numbers, Parameters, State};
use reference::enclosure::fastest_rate;

use crate::oracle::known_answers::KnownAnswer;

#[path = "../../../kernel/src/tests/tolerances.rs"]
mod shared;
pub use shared::*;

impl PerPrecision {
    /// Returns the tolerance for a method in 32 or in 64 bits. The plain and the compensated `f32`
    /// and the 32-bit fixed point have 32 bits; all other methods have 64.
    pub fn by(&self, method: Method) -> f64 {
        if method.is_single() || method.numbers() == Numbers::Fixed32 {
            self.single
        } else {
            self.double
        }
    }
}

/// The errors of the normal frequencies, fast and slow, the two mode shapes and the exchange
/// frequency, in units in the last place: nine roundings, halved by the square root, and up to ten
/// roundings.
pub const MODES: [f64; 5] = [4.0, 4.0, 10.0, 10.0, 10.0];

/// The error of the linear motion compared with the exact motion at 1e-6 rad, relative to the
/// amplitude: the neglected cubic term, 1e-12, times the radians swung in the ten seconds (up to
/// 200).
pub const LINEAR: f64 = 1e-9;

/// The excess over the bounds along a motion by RK4 with 0.05 rad per step, relative to each bound:
/// the energy error over 100 steps (measured: no excess at all).
pub const BOUNDS_DRIFT: f64 = 1e-6;

/// The error of one admissible step, over (fastest rate) dt: rad in an angle, and in units of the
/// fastest rate in a velocity. The two values are for the classical step and the direction form.
/// They were measured for the worst motions that a search found over masses 1e-6..1e6 and lengths
/// 1:100..100:1: 2.8e-5 and 7.7e-5.
pub const ADMISSIBLE: [f64; 2] = [3e-5, 8e-5];

/// The distance of the directions of the reference, which have no unit, from the proved enclosure,
/// to be multiplied by the growth of a small error: the roundings (1e-32) of some hundred steps of
/// double-double arithmetic (measured: within 3e-32, and within all digits of the table of known
/// answers).
pub const REFERENCE: f64 = 1e-31;

/// The radius of the enclosure of a direction, which has no unit, divided by the growth of a small
/// error (measured: 2.3e-28 at most).
pub const ENCLOSURE: f64 = 1e-27;

/// The largest distance of the mean energy of the misprinted form at figure 7 from -18.7 J, in J:
/// the spread of 32 chaotic runs of 100 s (measured -18.3 over 0..100 s, -18.9 over 5..100 s, and
/// falling further in longer runs).
pub const MISPRINT_ENERGY: f64 = 2.0;

/// The largest share, of 1, of its time that bob 2 of the misprinted form may be above the pivot
/// (measured 8.4 %).
pub const MISPRINT_ABOVE: f64 = 0.12;

/// The error of the displayed energy of the misprinted form in the first 5 s, J (measured 0.15,
/// where rod 2 is fastest).
pub const MISPRINT_SHOWN: f64 = 0.3;

/// The energies, J, below and above which the misprinted form must be at some time in the 10 s of
/// figure 7, from 62.9 at the start (measured -45 to 63.1). It does not conserve the energy.
pub const MISPRINT_SWING: [f64; 2] = [-40.0, 60.0];

/// Half of the last digit of the energy 62.9 J, in J.
pub const LAST_DIGIT_OF_62_9: f64 = 0.05;

/// The energy error of the right form at figure 7 with 512 steps per second for 100 s, J (measured
/// 2.4e-3 of 127).
pub const FIGURE_7_ENERGY: f64 = 0.01;

/// The largest distance of the share of time above the pivot of the right form from 0.507: the
/// spread of 32 chaotic runs of 100 s (measured 52.0 %).
pub const FIGURE_7_ABOVE: f64 = 0.03;

/// Returns the tolerance of a method compared with a known answer, for each sine and cosine; it has
/// no unit. `a1` and `a2` are the exact angles at that time, rad, with all turns. It is the growth
/// of a small error times the errors of plain RK4 in 4096 steps a second, which no other method
/// exceeds.
///
/// - Truncation: RK4 has an error of (W dt)^5/120 in each step of an oscillation of rate W. W is
///   the larger of the fast normal frequency and the largest angular velocity that the energy
///   allows. The total is W^5 dt^4 t/120.
/// - Rounding: each step rounds angles of size A by at most A epsilon/2. A random walk of n steps
///   gives A epsilon sqrt(n), doubled because increments near rest are rounded alike. A is 4 (pi,
///   up to its binade) or the exact angle.
/// - Evaluation: the velocities have an error of epsilon W sqrt((m1 + m2)/m1), because w1 is a
///   difference of momenta that are larger by this factor. The change of all rates by the rounding
///   of the parameters is as large.
///
/// Beyond the horizon of trust it exceeds 1 and the test claims nothing. [`KNOWN_ANSWERS_CLAIMED`]
/// counts the rows before it.
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

/// The number of rows of the table that must have a tolerance below 1, so that the test is
/// meaningful. The other rows are chaotic.
pub const KNOWN_ANSWERS_CLAIMED: PerPrecision = PerPrecision {
    single: 36.0,
    double: 45.0,
};

/// The relative error of the growth about the inverted rest in 1 s from a push of 1e-10 rad: the
/// contributions of the cubic term and of the other mode, which the rounding of the shape excites.
pub const INVERTED_GROWTH: f64 = 1e-9;

/// The largest relative excess of a step over dt, in epsilons of the method's numbers. The unit of
/// time may be rounded by half of the rounding of gravity.
pub const LONGER: f64 = 17.0;

/// The error of the time when a pendulum that stood upright has fallen by a radian, s: one sampling
/// interval, and RK4's error of the growth rate at 2^-6 s.
pub const FALL: f64 = 1.5 / 64.0;

/// The relative error of the time for which plain sums keep a pendulum upright. The fall begins at
/// a whole step, and w is rounded.
pub const STAYS: f64 = 0.05;

/// The limits of the amplitude of a swing of 1e-5 rad after 200 steps 2 % below and above the limit
/// of stability, rad: decayed and grown at least ten times (measured: to 6e-12 at most, to 7e-4 at
/// least).
pub const STABILITY_EDGE: [f64; 2] = [1e-6, 1e-4];

/// The directions compared with the angles of the same motion, in epsilons of the method's numbers:
/// roundings of the sines and the lengths.
pub const DIRECTIONS: f64 = 8.0;
/// The lengths of directions compared with 1, with 64 steps a second: the remainder after restoring
/// them to first order (measured 3e-6).
pub const LENGTHS: f64 = 1e-5;

/// The change of a pendulum at rest in 10,000 steps of 64-bit fixed point, rad and kg m^2/s: half
/// of a last digit in each step (measured 2.6e-13).
pub const REST_OF_FIXED_64: f64 = 1e-12;

/// Straight rods that turn evenly without gravity for 20 s: the error of the angles, rad, and that
/// of the sum of the momenta, relative. In f32 the error comes from some 5000 steps of plain sums,
/// each rounded. In f64 it is the direction form's own error, 6e-11 rad a second at 2 rad/s.
pub const STRAIGHT: PerPrecision = PerPrecision {
    single: 1e-3,
    double: 2e-9,
};

/// The error of a tiny swing compared with the cosine, relative to the amplitude, in 10 s: the
/// roundings of 2560 plain sums. RK4's own error is 1e-9.
pub const TINY: PerPrecision = PerPrecision {
    single: 1e-3,
    double: 1e-8,
};

/// The error of an angle after a million compensated steps of 2^-13 s of regular motion, rad
/// (measured 2e-7 and 9e-14; plain sums have an error of 2e-5 in f32).
pub const MILLION_STEPS: PerPrecision = PerPrecision {
    single: 5e-7,
    double: 3e-13,
};

/// The smallest ratio of the errors of a plain and a compensated form in `f32` in the regular scene
/// in 10 s (measured: 30 to 70).
pub const COMPENSATION_GAIN: f64 = 10.0;

/// The error of a frequency or period measured in a plotted curve where it crosses a level,
/// relative. It is half of the last digit given of the shortest, 1.3e-6, and the shift of a
/// crossing by joining the points with straight lines, (w dt)^3/16 of a radian or 2e-5 for the
/// fastest curve, over the 23 rad shown at least.
pub const PLOTTED_FREQUENCY: f64 = 3e-6;
/// The distance of the largest of a plotted curve's points from the maximum of the curve, relative
/// to this maximum. Between two points the curve is at most (w dt/2)^2/2 higher, 4e-4 for the
/// fastest envelope.
pub const PLOTTED_AMPLITUDE: f64 = 5e-4;

/// The error of the paths of figure 7, m: a hundredth of the width of its lines (measured: 3e-6).
pub const FIGURE_7_PATH: f64 = 1e-4;

/// The error of a frame before the planner's predicted horizon, pixels, where it is more than half
/// a pixel.
pub const PLAN_ERROR: f64 = 0.75;

/// The smallest ratio of the predicted to the true horizon, in the median of all scenes with a
/// finite horizon.
pub const PLAN_SHARE: f64 = 0.7;

/// The error of the planned height of a scene of curves, relative: the digits of the swing in
/// pixels, 21.5.
pub const SHOWN_HEIGHT: f32 = 1e-3;

/// The error of the linear beats after their period, relative to their amplitude. It is the same
/// for up to five turns.
pub const CLOSED: f64 = 5.0 * f32::EPSILON as f64 * 2.0 * 5.0 * std::f64::consts::TAU;

/// The smallest distance of the exact motion from its start at that time, pixels: more than the
/// width of a line.
pub const NOT_CLOSED: f64 = 1.0;

/// The error of the 32-bit fixed point in the regular scene for 10 s, rad, with steps so fine that
/// the method's error is smaller (measured 2e-9; compensated `f32` has 3e-8).
pub const FIXED_32_FLOOR: f64 = 5e-9;

/// The smallest error, rad, at which the order is measured in 32 bits. The errors by roundings
/// scatter from step to step, and are smaller in most of the tried motions.
pub const FIXED_32_ORDER_MEASURABLE: f64 = 5e-6;

/// The largest ratio of the errors of the 64-bit fixed point and of `f64` at the same steps in the
/// chaotic scene. If both are at their floors, the floor applies.
pub const FIXED_64_AGAINST_DOUBLE: f64 = 2.0;
/// The floor of both, rad: roundings of 2^-61, as often as weights of order 12 enlarge them, grow
/// 2000-fold in these 5 s.
pub const FIXED_64_FLOOR: f64 = 1e-12;

/// The error of a measured order of extrapolation, in orders. The steps must be coarse, so that
/// high orders are above the roundings of a hundred steps, which they enlarge. The next power of
/// the step then contributes (measured 5.98, 7.91, 12.34, 15.25). The next order is 2 off.
pub const ORDER_EXTRAPOLATED: f64 = 0.8;
/// The smallest share, of 1, of correct points, to a grey level, in a map of flips with a limit of
/// 10 sqrt(l/g), among the points that may turn over: the goal.
pub const FLIPS_RIGHT: f64 = 0.999;
/// The largest share, of 1, of wrong points, by more than a grey level, among the points that may
/// turn over, with a limit of 100 sqrt(l/g), where chaos leaves fewer correct ones.
pub const FLIPS_WRONG: f64 = 0.04;
/// The largest share, of 1, of points that are wrong without being in doubt. It is a share of the
/// points that may turn over.
pub const FLIPS_UNSUSPECTED: f64 = 0.01;

/// The largest difference of an angle between 64-bit fixed point and `f64` in three of the coarsest
/// allowed steps, rad.
pub const FIXED_64_AND_DOUBLE: f64 = 1e-9;

/// The error after a second of a motion with both rods turning over, in steps of 1/8192 s, by every
/// row of the table, rad and kg m^2/s: the method's error in double precision, the roundings of
/// single precision, and the sines of `micromath`.
pub const TURNING: [f64; 3] = [5e-7, 5e-3, 1.0];

/// The error after a second of a motion of 2e-5 rad in closed form, rad and kg m^2/s. In double
/// precision it is the nonlinear part and RK4's own error (measured 1.8e-13), in single precision a
/// few roundings (measured 1.4e-11).
pub const SMALL_MOTION: [f64; 2] = [3e-13, 2e-11];

/// The largest difference of the relative energy errors of a frame by the directions in 64 bits and
/// by the angles: some roundings of `f64`. The rounded numbers are three times as large as the
/// energy above rest, and the difference is relative to that energy.
pub const ENERGY_SHOWN: f64 = 1e-14;

/// The error of the displayed energy of the misprinted motion in its first second or until it has
/// diverged, relative to twice the largest potential energy. At large mass ratios this motion is
/// wilder than any true motion, and roundings are visible within a second.
pub const MISPRINT_ENERGY_SHOWN: f64 = 0.1;

/// The difference of the energy along a day in 32 bits from that of `f64` in the same steps,
/// relative to the energy above rest: the goal (measured at five mass ratios and three steps:
/// compensated `f32` up to 2.0e-4, plain 3.1e-4, fixed point 2.6e-6).
pub const DAY_ENERGY: f64 = 1e-3;
/// The change of the energy by moving back up to half a step, and by the roundings of directions
/// and momenta to `f32`, relative to the energy above rest: the goal.
pub const DAY_READING: f64 = 1e-4;
/// The error of the angles, rad, after a second of 1024 steps forward and back in 32 bits: the
/// effect of roundings that are carried into the next sum (measured 8e-8), and of roundings that
/// are dropped (measured 1.8e-6).
pub const RETURN_OF_32_BITS: [f64; 2] = [1e-7, 4e-6];

/// The relative error of a method's measured order: the next order contributes at the steps used,
/// and order 16 has the roundings (measured 3.73, 8.08, 10.04, 11.75 and 15.0). The second value is
/// for RK4 in finer steps (measured 3.93 to 3.995).
pub const ORDER_OF_METHODS: [f64; 2] = [0.1, 0.025];
