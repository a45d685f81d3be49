//! The tolerances that several tests share, with their reasons. All others are beside their test.
//!
//! The growth is about the factor by which a small error of the start has grown.

use crate::enclosure::fastest_rate;
use double_pendulum::{Method, Numbers, Parameters, State};

use crate::known_answers::KnownAnswer;

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

/// The distance by which a sine or cosine of the reference, which has no unit, may be outside the
/// proved interval, to be multiplied by the growth and, in the test `motions`, by the larger angle
/// of the start if it is above 1 rad: the roundings (1e-32) of some hundred steps of double-double
/// arithmetic (measured: within 3e-32, and within all digits of the table of known answers).
pub const REFERENCE: f64 = 1e-31;

/// Returns the tolerance of a method compared with a known answer, for each sine and cosine: the
/// growth times the sum of three errors of plain RK4 in 4096 steps a second, which no other of the
/// [`exact_methods`](crate::trials::exact_methods) exceeds.
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
/// Where the tolerance exceeds 1, the test claims nothing. `KNOWN_ANSWERS_CLAIMED` counts the
/// other rows.
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

/// The smallest allowed median of the ratio of the predicted to the true accuracy horizon, over the
/// motions whose horizon ends within the test's run.
pub const PLAN_SHARE: f64 = 0.7;
