//! The tolerances of tests, with their reasons. The tolerance of a single motion is stored with the
//! motion. A constant that is called an error, a difference or a distance is the largest allowed
//! one. Some tests allow a value that is equal to a limit, others do not. A relative one has no
//! unit. Energies are 0 where both bobs are level with the pivot.
//!
//! - The reference is the exact motion to about 30 digits
//!   ([`Reference`](reference::taylor::Reference)).
//! - The enclosure is a set of intervals that are proved to contain the exact motion
//!   ([`Enclosure`](reference::enclosure::Enclosure)).
//! - The growth is about the factor by which a small error of the start has grown.
//! - The regular and the chaotic scene are [`Trial::regular`] and [`Trial::chaotic`].
//! - Figure 7 of the page is a motion from rest at 171 degrees, with rods of 1 m, bobs of 1 kg and
//!   2.75 kg, and g = 9.8 m/s^2.
//! - The right form is the kernel's equations; the misprinted form is those of
//!   [`misprinted_equal_rods`].
//!
//! [`Trial::regular`]: crate::oracle::trials::Trial::regular
//! [`Trial::chaotic`]: crate::oracle::trials::Trial::chaotic
//! [`misprinted_equal_rods`]: crate::oracle::textbook::misprinted_equal_rods

use double_pendulum::{Method, Numbers, Parameters, State};
use reference::enclosure::fastest_rate;

use crate::oracle::known_answers::KnownAnswer;

#[path = "../../../kernel/src/tests/tolerances.rs"]
mod shared;
pub use shared::*;

impl PerPrecision {
    /// Returns the tolerance for a method by its numbers, whatever its equations: `single` for
    /// plain and compensated `f32` and for 32-bit fixed point, and `double` for all others.
    pub fn by(&self, method: Method) -> f64 {
        if method.is_single() || method.numbers() == Numbers::Fixed32 {
            self.single
        } else {
            self.double
        }
    }
}

/// The errors of the fast and the slow normal frequency, of the fast and the slow mode shape, and
/// of the difference of the frequencies, in ulps of the numbers, `f32` or `f64`: nine roundings,
/// halved by the square root, and up to ten roundings.
pub const MODES: [f64; 5] = [4.0, 4.0, 10.0, 10.0, 10.0];

/// The error of the linear motion compared with the exact motion at 1e-6 rad, within 10 s, relative
/// to the amplitude and, in velocities, to the amplitude times the fast frequency: five times the
/// neglected cubic term, 1e-12, times the radians swung in that time (up to 200).
pub const LINEAR: f64 = 1e-9;

/// The excess over the bounds from the energy along 100 steps of RK4, in which no rod turns by more
/// than 0.05 rad each, relative to each bound: the energy error of the steps (measured: no excess
/// at all).
pub const BOUNDS_DRIFT: f64 = 1e-6;

/// The error of one admissible step, divided by the fastest rate times dt, which is 1/4: rad in an
/// angle, and in units of the fastest rate in a velocity. The first value is for RK4 in angles
/// (`Pendulum::step`), the second for the direction form. They were measured for the worst motions
/// that a search found over masses 1e-6..1e6 and lengths 1:100..100:1: 2.8e-5 and 7.7e-5.
pub const ADMISSIBLE: [f64; 2] = [3e-5, 8e-5];

/// The distance by which a sine or cosine of the reference, which has no unit, may be outside the
/// proved interval, to be multiplied by the growth and, in the test `motions`, by the larger angle
/// of the start if it is above 1 rad: the roundings (1e-32) of some hundred steps of double-double
/// arithmetic (measured: within 3e-32, and within all digits of the table of known answers).
pub const REFERENCE: f64 = 1e-31;

/// The radius of the enclosure of a sine or cosine, which has no unit, divided by the growth
/// (measured: 2.3e-28 at most).
pub const ENCLOSURE: f64 = 1e-27;

/// The largest distance of the mean energy of the misprinted form at figure 7 from -18.7 J, in J.
/// The mean is over all 100 s of 32 chaotic runs, whose spread the tolerance covers (measured
/// -18.3, without the first 5 s -18.9, and falling further in longer runs).
pub const MISPRINT_ENERGY: f64 = 2.0;

/// The largest share, of 1, of the time of the same runs ([`MISPRINT_ENERGY`]) that bob 2 of the
/// misprinted form may be above the pivot (measured 8.4 %).
pub const MISPRINT_ABOVE: f64 = 0.12;

/// The error, J, of the displayed energy of the misprinted form at figure 7 in the first 5 s,
/// compared with the same equations in `f64` and finer steps (measured 0.15, where rod 2 is
/// fastest).
pub const MISPRINT_SHOWN: f64 = 0.3;

/// Two energies, J. The plotted path of the misprinted form must reach the first or less, and more
/// than the second, at some time in the first 10 s of figure 7. It does not conserve the energy
/// (measured -45 to 63.1, from 62.9 at the start).
pub const MISPRINT_SWING: [f64; 2] = [-40.0, 60.0];

/// Half of the last digit of the energy 62.9 J, in J.
pub const LAST_DIGIT_OF_62_9: f64 = 0.05;

/// The energy error, J, of the right form at figure 7 in RK4 with 512 steps per second, in 32 runs
/// of 100 s (measured 2.4e-3, of 127 J above rest). It is also the largest difference of two
/// energies along the plotted path.
pub const FIGURE_7_ENERGY: f64 = 0.01;

/// The largest distance from 0.507 of the share, of 1, of the time that bob 2 of the right form is
/// above the pivot in these runs ([`FIGURE_7_ENERGY`]), which are chaotic and whose spread it
/// covers (measured 52.0 %).
pub const FIGURE_7_ABOVE: f64 = 0.03;

/// Returns the tolerance of a method compared with a known answer, for each sine and cosine; it has
/// no unit. `a1` and `a2` are the exact angles at that time, rad, with all turns; the momenta are
/// not used. It is the growth times the sum of three errors of plain RK4 in 4096 steps a second,
/// which no other of the [`exact_methods`](crate::oracle::trials::exact_methods) exceeds.
///
/// - Truncation: RK4 has an error of (W dt)^5/120 in each step of an oscillation of rate W. W is
///   the larger of the fast normal frequency and the largest angular velocity that the energy
///   allows. The total is W^5 dt^4 t/120.
/// - Rounding: each step rounds angles of size A by at most A epsilon/2. A random walk of n steps
///   gives half of A epsilon sqrt(n). It is doubled because increments near rest are rounded alike.
///   A is the largest of both exact angles and 4 (pi, up to its binade).
/// - Evaluation: the velocities have an error of epsilon W sqrt((m1 + m2)/m1), because w1 is a
///   difference of momenta that are larger by this factor. The total is
///   epsilon W t sqrt((m1 + m2)/m1). The change of all rates by the rounding of the parameters is
///   as large, and is not added.
///
/// The epsilon is that of `f32` for numbers in `f32` and in 32-bit fixed point, and that of `f64`
/// otherwise. Where the tolerance exceeds 1, the test claims nothing. [`KNOWN_ANSWERS_CLAIMED`]
/// counts the other rows. Not checked: that the angles are finite.
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

/// The smallest number of rows of the table for which a method must have a tolerance below 1
/// ([`known_answer`]), so that the test is meaningful. The other rows are chaotic.
pub const KNOWN_ANSWERS_CLAIMED: PerPrecision = PerPrecision {
    single: 36.0,
    double: 45.0,
};

/// The relative error of the factor by which a push of 1e-10 rad from both rods straight up grows
/// in 1 s, in the reference compared with e to the power of a mode's frequency: the contributions
/// of the cubic term and of the other mode, which the rounding of the shape excites.
pub const INVERTED_GROWTH: f64 = 1e-9;

/// The largest relative excess of a step over dt, in epsilons of the method's numbers, or of `f32`
/// in fixed point. The unit of time may be rounded by half of the rounding of gravity.
pub const LONGER: f64 = 17.0;

/// The error of the time when rod 1 of a pendulum that stood upright has fallen by a radian, s,
/// compared with the reference: one sampling interval, 1/64 s, and RK4's error of the growth rate
/// in steps of 2^-6 s.
pub const FALL: f64 = 1.5 / 64.0;

/// The error of the time for which plain sums of angles keep a pendulum upright, relative to the
/// predicted time. The fall begins at a whole step, and the angular velocity is rounded.
pub const STAYS: f64 = 0.05;

/// Two limits of the largest angle of a swing from 1e-5 rad in steps 101 to 200, rad. It must be
/// below the first in steps 2 % below the limit of stability, and above the second in steps 2 %
/// above it: decayed and grown at least ten times (measured: to 6e-12 at most, to 7e-4 at least).
pub const STABILITY_EDGE: [f64; 2] = [1e-6, 1e-4];

/// The difference of the directions, across them, from the sines and cosines of the angles of the
/// same motion, in epsilons of the method's numbers, or of `f32` in fixed point: roundings of the
/// sines and of the lengths. The turn of a rod in the excess of all steps ([`LONGER`]) is allowed
/// in addition.
pub const DIRECTIONS: f64 = 8.0;
/// The difference of the lengths of directions from 1, by each of the
/// [`exact_methods`](crate::oracle::trials::exact_methods), in 70 steps of 1/64 s of the chaotic
/// scene and of [`Trial::unlike`](crate::oracle::trials::Trial::unlike): the remainder after
/// restoring them to first order (measured 3e-6).
pub const LENGTHS: f64 = 1e-5;

/// The change of each angle, rad, and of each momentum, kg m^2/s, of a pendulum at rest in 10,000
/// steps of 64-bit fixed point, in which numbers are rounded (measured 2.6e-13).
pub const REST_OF_FIXED_64: f64 = 1e-12;

/// Straight rods that turn evenly without gravity for 20 s: the error of the angles, rad, and that
/// of the sum of the momenta, relative. In f32 the error comes from some 5000 steps of plain sums,
/// each rounded. In f64 it is the direction form's own error, 6e-11 rad a second at 2 rad/s.
pub const STRAIGHT: PerPrecision = PerPrecision {
    single: 1e-3,
    double: 2e-9,
};

/// The error of a tiny swing in the slow mode compared with the cosine, relative to the amplitude,
/// in 10 s of steps of 1/256 s, in floating point: the roundings of 2560 plain sums. RK4's own
/// error is 1e-9.
pub const TINY: PerPrecision = PerPrecision {
    single: 1e-3,
    double: 1e-8,
};

/// The error of an angle, rad, along a million compensated steps of 2^-13 s of the regular scene,
/// in `f32` and in the `f64` of
/// [`Trial::states_in_f64`](crate::oracle::trials::Trial::states_in_f64) (measured 2e-7 and 9e-14;
/// plain sums have an error of 2e-5 in `f32`).
pub const MILLION_STEPS: PerPrecision = PerPrecision {
    single: 5e-7,
    double: 3e-13,
};

/// The smallest ratio of the errors of the plain and the compensated direction form in `f32` in the
/// regular scene in 10 s, in steps of 1/256 and 1/1024 s (measured: 30 to 70).
pub const COMPENSATION_GAIN: f64 = 10.0;

/// The error of a frequency or period measured in a plotted curve where it crosses a level,
/// relative. It is half of the last digit of the shortest given number, 1.3e-6, and the shift of a
/// crossing by joining the points with straight lines, which is (w dt)^3/16 of a radian for points
/// dt apart and a frequency w, or 2e-5 for the fastest curve, over the 23 rad shown at least.
pub const PLOTTED_FREQUENCY: f64 = 3e-6;
/// The distance of the largest of a plotted curve's points from the maximum of the curve, relative
/// to this maximum. Between two points, dt apart, a curve of frequency w is at most (w dt/2)^2/2
/// higher, 4e-4 for the fastest envelope. A curve that is nearer to its envelope than this part of
/// the maximum touches it.
pub const PLOTTED_AMPLITUDE: f64 = 5e-4;

/// The error of each plotted position of bob 2 in the 10 s of figure 7, m: a hundredth of the width
/// of its lines (measured: 3e-6).
pub const FIGURE_7_PATH: f64 = 1e-4;

/// The error, in units of half a pixel, of a frame that is wrong by more than half a pixel before
/// the planner's predicted horizon. It has no effect, because the test that uses it allows no such
/// frame.
pub const PLAN_ERROR: f64 = 0.75;

/// The smallest allowed median of the ratio of the predicted to the true accuracy horizon, over the
/// motions whose horizon ends within the test's run.
pub const PLAN_SHARE: f64 = 0.7;

/// The relative error of the height, pixels, for which a scene of beats is planned. The expected
/// height follows from the length of its largest swing, 21.5 pixels, a number of three digits.
pub const SHOWN_HEIGHT: f32 = 1e-3;

/// The error of the angles of the linear motion in a scene of beats after the period in which its
/// figure closes, relative to their amplitude: 3.7e-5. It is computed for five periods of the fast
/// mode, the most in any of these scenes.
pub const CLOSED: f64 = 5.0 * f32::EPSILON as f64 * 2.0 * 5.0 * std::f64::consts::TAU;

/// The smallest distance of the figure of the exact motion from its start after the period of
/// [`CLOSED`], pixels: more than the width of a line.
pub const NOT_CLOSED: f64 = 1.0;

/// The error of the angles by 32-bit fixed point in the regular scene for 10 s, rad, with steps so
/// fine that the method's error is smaller (measured 2e-9; compensated `f32` has 3e-8). It is also
/// the error of a start's momenta as they are reported, kg m^2/s.
pub const FIXED_32_FLOOR: f64 = 5e-9;

/// The smallest error, rad, at which the order is measured in 32-bit fixed point. The errors by
/// roundings scatter from step size to step size, and are smaller than this in most of the tried
/// motions.
pub const FIXED_32_ORDER_MEASURABLE: f64 = 5e-6;

/// The largest ratio of the errors of 64-bit fixed point and of `f64` by extrapolation of order 12,
/// in the same steps, in 5 s of the chaotic scene. The error of `f64` counts as at least half of
/// [`FIXED_64_FLOOR`].
pub const FIXED_64_AGAINST_DOUBLE: f64 = 2.0;
/// The error of an angle by 64-bit fixed point, rad, that is due to its roundings alone. In the
/// chaotic scene roundings of 2^-61, as often as weights of order 12 enlarge them, grow 2000-fold
/// in 5 s.
pub const FIXED_64_FLOOR: f64 = 1e-12;

/// The error of the measured order of extrapolation of z'' = -z, in orders. The steps must be
/// coarse, so that high orders are above the roundings of a hundred steps, which they enlarge. The
/// next power of the step then contributes (measured 5.98, 7.91, 12.34, 15.25 for the orders 6, 8,
/// 12 and 16). The next order is 2 off.
pub const ORDER_EXTRAPOLATED: f64 = 0.8;
/// The smallest share, of 1, of correct points in a map of flips with a limit of 10 sqrt(l/g),
/// among the points that may turn over. A point is correct if it differs from far finer steps in
/// `f64` by at most one grey level of the panel's map, which has 14 for the time of a flip.
pub const FLIPS_RIGHT: f64 = 0.999;
/// The largest share, of 1, of points that are wrong by more than a grey level, as in
/// [`FLIPS_RIGHT`], but in a map with a limit of 100 sqrt(l/g), where chaos leaves fewer correct
/// ones.
pub const FLIPS_WRONG: f64 = 0.04;
/// The largest share, of 1, of points that are wrong without being in doubt, among the points that
/// may turn over, in a map with a limit of 100 sqrt(l/g). A point is in doubt if half the step
/// changes it by more than a grey level.
pub const FLIPS_UNSUSPECTED: f64 = 0.01;

/// The largest difference of an angle, rad, between 64-bit fixed point and `f64` after three steps,
/// which are at least half as long as the longest accepted ones.
pub const FIXED_64_AND_DOUBLE: f64 = 1e-9;

/// The difference from `rk4-f64` within a second of a motion with both rods turning over, in steps
/// of 1/8192 s, by every method but the closed form, rad and kg m^2/s. The first value is for `f64`
/// and 64-bit fixed point, the second for `f32` and 32-bit fixed point, and the third for the sines
/// of `micromath`.
pub const TURNING: [f64; 3] = [5e-7, 5e-3, 1.0];

/// The difference of the closed form from `rk4-f64` within a second of a motion of 2e-5 rad, rad
/// and kg m^2/s. In double precision, the first value, it is the nonlinear part and RK4's own error
/// (measured 1.8e-13), in single precision a few roundings (measured 1.4e-11).
pub const SMALL_MOTION: [f64; 2] = [3e-13, 2e-11];

/// The largest difference of the relative energy errors of a frame by the directions in 64 bits and
/// by the angles: some roundings of `f64`. The rounded numbers are three times as large as the
/// energy above rest, and the difference is relative to that energy.
pub const ENERGY_SHOWN: f64 = 1e-14;

/// The error of the displayed energy of a misprinted motion in its first second or until it has
/// diverged, compared with the same equations in `f64` and finer steps, relative to twice the
/// largest potential energy. At large mass ratios this motion is wilder than any true motion, and
/// roundings are visible within a second.
pub const MISPRINT_ENERGY_SHOWN: f64 = 0.1;

/// The difference of the energy by a method in 32 bits from that of `f64` in the same steps, at any
/// time of a simulated day, relative to the energy above rest: the goal (measured at five mass
/// ratios and three steps: compensated `f32` up to 2.0e-4, plain 3.1e-4, fixed point 2.6e-6).
pub const DAY_ENERGY: f64 = 1e-3;
/// The difference of the energy of a run's directions and momenta from that of its state, in 32
/// bits, relative to the energy above rest: the goal. The state is up to half a step away, and the
/// directions and momenta are rounded to `f32`.
pub const DAY_READING: f64 = 1e-4;
/// The error of the angles, rad, after a second of 1024 steps forward and as many back in 32 bits.
/// The first value is for compensated `f32` and fixed point (measured 8e-8), the second for plain
/// `f32`, whose roundings are dropped (measured 1.8e-6).
pub const RETURN_OF_32_BITS: [f64; 2] = [1e-7, 4e-6];

/// The relative error of a method's measured order. The first value is for every method: the next
/// order contributes at the steps used, and order 16 has the roundings (measured 3.73, 8.08, 10.04,
/// 11.75 and 15.0). The second value is for RK4 in `f64` in finer steps (measured 3.93 to 3.995).
pub const ORDER_OF_METHODS: [f64; 2] = [0.1, 0.025];
