//! Shadows: motions close to another one, which measure how its rounding errors grow.
//!
//! A run in 64 bits makes a small rounding error in every frame. The motion propagates these errors
//! and, if it is chaotic, they grow exponentially. Small errors are propagated linearly. Larger
//! distances therefore grow by the same factors, as long as they stay small, and such distances can
//! be computed in 32 bits and in coarse steps. A *shadow* is a motion at such a distance.
//!
//! # The covariance of the errors
//!
//! The error of a run is a random vector e = (a1, a2, p1/s1, p2/s2), with the momenta divided by
//! [`scales`]. A frame is assumed to add an independent error of standard deviation q to each of
//! the four numbers. Five shadows represent the covariance matrix P of e. With the 4 x 4 matrix D
//! of the differences of four of them, its columns, from the central one,
//!
//! ```text
//! P = u^2 D D^T + n q^2 I
//! ```
//!
//! where n is the number of frames since the last restart (see below), and u is the error that a
//! distance of 1 rad stands for. All five have about the same truncation error, so that it cancels
//! in D. At the start D is diagonal, because the four numbers are rounded independently: both
//! angles by the same amount, and each momentum in proportion to its value.
//!
//! The shadows are *restarted* when one is farther than 4 [`NEAR`] from the central one, or after
//! some time:
//!
//! 1. Compute P, and its Cholesky factor L, so that L L^T = P. Any D with the same u^2 D D^T
//!    represents the same errors.
//! 2. Choose u such that the largest standard deviation in L/u is [`NEAR`].
//! 3. Start the central shadow at the state of the fine run of the reference, and the others beside
//!    it at the columns of L/u. Set n to 0.
//!
//! A restart adds the errors of the last n frames, in all four dimensions. Restarts must be
//! frequent at first: an error that shrinks at first may grow most later, so that the error of a
//! later frame can grow a hundred times as much as an error of the start. After errors have grown
//! by 1e5, new ones hardly matter. The shadows are then restarted only if their distances are no
//! longer small, or after a longer time.
//!
//! # The result
//!
//! The error of a frame is u times the root of the sum of the squares of the four displacements,
//! plus q sqrt(n) times the length of both rods for the last n frames. Since q is larger than the
//! rounding errors, this is used as an upper bound. If a shadow is so far that errors no longer
//! grow in proportion, the error is unknown.

use super::candidate::{distance, greater};
use super::cost::{Costs, MOST_STEPS, Stepping, steps_to_frame};
use super::problem::Problem;
use super::trial::Run;
use crate::bounds::Bounds;
use crate::error::{Error, Parameter};
use crate::methods::Advance;
use crate::methods::any::Motion32;
use crate::pendulum::{Direction, Parameters, Pendulum, State};
use crate::table::Method;

/// The longest step of the shadows as a multiple of the admissible step.
const STEP: f64 = 1.0;
/// The largest standard deviation that the shadows represent after a restart, in units of
/// [`scales`]. At the start, the distance of a shadow that differs in an angle, rad.
const NEAR: f64 = 1.0 / (1 << 13) as f64;
/// The distance at which the shadows are restarted, rad.
const FAR: f32 = 4.0 * NEAR as f32;
/// The growth of the errors after which new rounding errors hardly matter. It is the error that the
/// farthest shadow stands for, divided by the error of the start or of a frame, whichever is
/// larger.
const GROWN: f32 = 1e5;
/// The distance at which the shadows are restarted after errors have grown by [`GROWN`], rad.
const FARTHEST: f32 = 1.0 / (1 << 8) as f32;
/// The distance beyond which the error is unknown, rad.
const LARGEST: f32 = 0.25;
/// The factor on the number of frames between two restarts after errors have grown by [`GROWN`].
/// The factor 16 was too large: the rounding errors of the shadows themselves changed the columns
/// of D, and the error of a frame was 13 times as large as they showed.
const SELDOM: u32 = 3;
/// The time between two restarts, as the phase that the fastest rate advances in it, rad.
const PHASE: f64 = 12.0;
/// The smallest number of frames between two restarts, except those that are due by distance. With
/// a heavy bob 2, the phase [`PHASE`] may pass within one frame.
const FEWEST_FRAMES: u16 = 8;
/// The smallest diagonal element of the Cholesky factor, as a share of the largest standard
/// deviation. It only avoids a division by almost 0: the digits of the shadows end at 2^-17 of
/// [`NEAR`] in fixed point, and at 2^-10 in `f32`.
const SMALLEST: f64 = 1.0 / (1 << 26) as f64;

/// The number of shadows: the central one, and one for each dimension of phase space.
const SHADOWS: usize = 5;

/// The assumed standard deviation of the rounding error of a run in 64 bits: of the start, rad, and
/// of each step, rad. Within a frame the errors of the steps are added; over several frames the
/// squares of the errors of the frames are added.
///
/// The values are measured upper estimates. When both were a third larger, the largest error of
/// 2,000 high starts, before a horizon that rounding ends, was 0.63 tolerances. With half of both,
/// four of 2,000 on a Cortex-M4F were inaccurate before their horizon, by up to 1.6 tolerances.
/// Test `plan_study` checks the bound against the exact motion.
const ROUNDING: [f32; 2] = [9e-16, 3.6e-17];

/// The factor on the rounding error of a step unless 1/2 < l1/l2 <= 1. Outside that range
/// [`Fixed64`](crate::Fixed64) has different units for the rates of the two rods. Measured, too.
const UNLIKE_UNITS: f32 = 6.0;

/// The rows of a matrix, which belong to a1, a2, p1 and p2 in units of [`scales`].
type Matrix = [[f64; 4]; 4];

/// A central motion and four others close to it.
///
/// First, [`prepare`](Self::prepare) is called until all [are prepared](Self::are_prepared). For
/// each frame, all [`runs`](Self::runs) are advanced to the frame, and the frame is
/// [compared](Self::compare). After that they are [restarted](Self::restart) if that [is
/// due](Self::is_due).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shadows {
    /// The central shadow and the other four.
    runs: [Run<Motion32>; SHADOWS],
    /// The units of the momenta ([`scales`]), kg m^2/s.
    scales: [f64; 2],
    /// u: the error that a distance of 1 rad stands for, rad; NaN after a refused restart.
    unit: f32,
    /// n: the number of frames since the start or the last restart.
    frames: u32,
    /// The number of frames after which they are restarted at the latest; [`SELDOM`] times as many
    /// once the errors have grown by [`GROWN`].
    most_frames: u16,
    /// True if the shadows must be restarted.
    is_due: bool,
    /// q: the rounding error of one frame, rad.
    frame_error: f32,
}

impl Shadows {
    /// Returns the usual method and step count of shadows. `method` is in 32 bits, and `admissible`
    /// is the [longest step that resolves the motion](super::cost::admissible_step), s.
    pub fn stepping(method: Method, frame_rate: u16, admissible: f64) -> Stepping {
        let steps = steps_to_frame(method, frame_rate, STEP * admissible);
        Stepping { method, steps }
    }

    /// Creates the shadows of a motion in 64 bits that makes `steps` steps per frame. The shadows
    /// themselves are computed by `stepping`, or in finer steps if the method refuses these as too
    /// long. `scales` are the units of the momenta ([`scales`]), kg m^2/s. `admissible` is the
    /// [longest step that resolves the motion](super::cost::admissible_step), s; infinite if
    /// nothing can move.
    ///
    /// No motion is prepared yet. [`prepare`](Self::prepare) reports a pendulum that is refused,
    /// and a `stepping` that is not in 32 bits or has 0 steps.
    pub fn new(
        stepping: Stepping,
        problem: &Problem,
        scales: [f64; 2],
        admissible: f64,
        steps: u32,
    ) -> Self {
        let [of_start, of_step] = ROUNDING;
        let Parameters { l1, l2, .. } = problem.pendulum;
        let has_like_units = 0.5 * l2 < l1 && l1 <= l2;
        let unlike = if has_like_units { 1.0 } else { UNLIKE_UNITS };

        Self {
            runs: [Run::new(stepping); SHADOWS],
            scales,
            // A distance of NEAR stands for the rounding error of the start.
            unit: of_start / NEAR as f32,
            frames: 0,
            most_frames: frames_between(admissible, problem.rate),
            is_due: false,
            frame_error: unlike * of_step * steps as f32,
        }
    }

    /// Returns the cost of a frame of shadows that are computed by `stepping`, in the unit of
    /// `costs`. It includes the share of a frame in the restarts that are due by the phase, but not
    /// in those that are due by distance.
    ///
    /// `admissible` is the [longest step that resolves the motion](super::cost::admissible_step),
    /// s, and `frame_rate` is the number of frames per second.
    pub fn cost_of_frame(
        stepping: Stepping,
        admissible: f64,
        frame_rate: u16,
        costs: &Costs,
    ) -> f32 {
        let frames = frames_between(admissible, frame_rate);
        SHADOWS as f32 * costs.of_frame(stepping) + costs.preparation / frames as f32
    }

    /// Returns the runs of all shadows. Some may not be prepared yet, or may have diverged.
    pub fn runs(&mut self) -> impl Iterator<Item = &mut Run<Motion32>> {
        self.runs.iter_mut()
    }

    /// Returns true if all shadows are prepared.
    pub fn are_prepared(&self) -> bool {
        self.runs.iter().all(|run| run.motion.is_some())
    }

    /// Returns true if the shadows must be [restarted](Self::restart) before the next
    /// frame.
    pub fn is_due(&self) -> bool {
        self.is_due
    }

    /// Prepares one shadow that is not prepared yet, at or beside `start`, the start of the motion
    /// in SI units. If the method refuses the steps of the central shadow as too long, this gives
    /// all shadows finer steps instead. Does nothing if all are prepared. `problem` must be that of
    /// [`new`](Self::new); this is not checked.
    ///
    /// # Errors
    ///
    /// Returns the error of the method if it refuses the shadow on both sides of `start`; the
    /// shadows are unchanged then.
    pub fn prepare(&mut self, problem: &Problem, start: &State<f64>) -> Result<(), Error> {
        // Select a shadow that is not prepared.
        let mut runs = self.runs.iter_mut().enumerate();
        let Some((number, run)) = runs.find(|(_, run)| run.motion.is_none()) else {
            return Ok(());
        };

        // At the start both angles are rounded by the same amount, and each momentum in proportion
        // to its value. Run 0 is the central one, and run i + 1 differs in number i of the state.
        let scales = self.scales;
        let [of_p1, of_p2] = scales;
        let shares = [1.0, 1.0, start.p1 / of_p1, start.p2 / of_p2];
        let difference = |sign: f64| {
            core::array::from_fn(|i| {
                let share = if number == i + 1 { shares[i] } else { 0.0 };
                sign * NEAR * share
            })
        };

        // Create it on one side of the motion or, if the method refuses that, on the other.
        let Stepping { method, steps } = run.stepping;
        let dt = 1.0 / (f64::from(problem.rate) * f64::from(steps));
        let prepared = |sign: f64| {
            let start = beside(start, difference(sign), scales);
            Motion32::new(method, &problem.pendulum, &start, dt)
        };
        let prepared = prepared(1.0).or_else(|_| prepared(-1.0));

        // All shadows make the same steps, so only the first one can change them.
        if let Err(Error::TooLarge {
            parameter: Parameter::Dt,
            limit,
            ..
        }) = prepared
        {
            if number == 0 && steps < MOST_STEPS {
                let enough = steps_to_frame(method, problem.rate, limit);
                for run in &mut self.runs {
                    run.stepping.steps = enough.max(2 * steps);
                }
                return Ok(());
            }
        }
        run.motion = Some(prepared?);
        Ok(())
    }

    /// Restarts all shadows beside the state `fine`, and adds the rounding errors of the frames
    /// since the last restart to their differences. `fine` is the state of the fine run at the same
    /// frame, in SI units. If the method refuses a shadow, because a number is not finite, the
    /// error is unknown from then on.
    pub fn restart(&mut self, fine: &State<f64>) {
        // Collect the differences from the central shadow: D, a row for each number of the state.
        let scales = self.scales;
        let places = self.runs.each_ref().map(Place::of);
        let [center, others @ ..] = &places;
        let mut rows = [[0.0; 4]; 4];
        for (column, other) in others.iter().enumerate() {
            let difference = other.minus(center, scales);
            for (row, number) in rows.iter_mut().zip(difference) {
                row[column] = number;
            }
        }

        // Compute the variance that the last frames add, in the unit of squared differences, rad^2,
        // and L/u for the present u.
        let added = f64::from(self.frame_error / self.unit);
        let variance = added * added * f64::from(self.frames);
        let largest = rows.iter().map(|row| dot(row, row)).fold(0.0, f64::max) + variance;
        let factor = cholesky(&rows, variance, SMALLEST * SMALLEST * largest);

        // Scale L/u such that the largest standard deviation is NEAR, and u by the inverse factor,
        // so that the represented errors stay the same.
        let deviation = libm::sqrt(largest);
        let scale = NEAR / deviation;
        self.unit *= (deviation / NEAR) as f32;
        self.frames = 0;
        self.is_due = false;

        // Start the central shadow at the state itself, and the others at the columns.
        for (number, run) in self.runs.iter_mut().enumerate() {
            if let Some(shadow) = &mut run.motion {
                let difference = match number.checked_sub(1) {
                    // The remainder changes nothing; it avoids a check of the index.
                    Some(column) => factor.map(|row| scale * row[column % 4]),
                    None => [0.0; 4],
                };
                match shadow.started(&beside(fine, difference, scales)) {
                    Ok(started) => *shadow = started,
                    Err(_) => self.unit = f32::NAN,
                }
            }
        }
    }

    /// Returns q sqrt(n): the rounding error of all frames since the last restart, without its
    /// growth, rad.
    fn recent_error(&self) -> f32 {
        self.frame_error * libm::sqrtf(self.frames as f32)
    }

    /// Compares the shadows with each other at a frame. Every frame after the start must be
    /// compared once, in order, because rounding errors add up. All steps towards it must have been
    /// made. Neither is checked. A shadow that is not prepared counts as diverged.
    ///
    /// Returns an upper bound of the rounding error of a motion in 64 bits that makes the `steps`
    /// per frame of [`new`](Self::new), in units of the tolerance. It is exceeded only in rare
    /// cases. `rods` are the lengths of the rods in the same unit.
    ///
    /// The result is NaN if the error is unknown: if a shadow has diverged or is now farther than
    /// [`LARGEST`], or if a method has refused a shadow in [`restart`](Self::restart).
    pub fn compare(&mut self, rods: [f32; 2]) -> f32 {
        self.frames = self.frames.saturating_add(1);

        // Measure the distances from the central shadow.
        let [center, others @ ..] = self.runs.each_mut().map(Run::frame);
        let mut farthest = 0.0;
        let mut squares = 0.0;
        for other in &others {
            farthest = greater(distance([1.0; 2], other, &center), farthest);
            let shown = distance(rods, other, &center);
            squares += shown * shown;
        }

        // Restart when distances are no longer small or when new errors must be added. Once the
        // errors have grown, new ones hardly matter.
        let [of_start, _] = ROUNDING;
        let has_grown = self.unit * farthest > GROWN * greater(of_start, self.frame_error);
        self.is_due = if has_grown {
            farthest > FARTHEST || self.frames >= SELDOM * u32::from(self.most_frames)
        } else {
            farthest > FAR || self.frames >= u32::from(self.most_frames)
        };

        if farthest > LARGEST {
            return f32::NAN;
        }

        // Add the errors of the last frames, which the shadows do not contain yet. If both angles
        // are wrong by e, bob 2 is displaced by at most e times the sum of the rods' lengths.
        let [rod1, rod2] = rods;
        self.unit * libm::sqrtf(squares) + self.recent_error() * (rod1 + rod2)
    }
}

/// Returns the largest number of frames between two restarts before errors have grown: those in
/// which the fastest rate that the energy allows advances a phase by [`PHASE`], from 8
/// ([`FEWEST_FRAMES`]) to 65,535. `admissible` is the admissible step, s, in which that rate
/// advances a phase by 1/4 rad. `frame_rate` is the number of frames per second.
fn frames_between(admissible: f64, frame_rate: u16) -> u16 {
    let frames = PHASE * 4.0 * admissible * f64::from(frame_rate);
    (frames as u16).max(FEWEST_FRAMES)
}

/// Returns the units of the momenta p1 and p2, kg m^2/s: the largest momenta that the energy of
/// `start` allows ([`Bounds`]), because rounding errors of fixed point are relative to these. An
/// energy of less than a millionth of the turnover energy counts as that millionth. A unit is 1 if
/// its bound is 0, because nothing can move. The unit of both angles is 1 rad.
pub(super) fn scales(pendulum: &Pendulum<f64>, start: &State<f64>) -> [f64; 2] {
    const LEAST: f64 = 1e-6;
    let energy = pendulum.energy_above_rest(start);
    let energy = f64::max(energy, LEAST * pendulum.turnover_energy());
    let bounds = Bounds::new(pendulum.parameters(), energy);
    [bounds.p1, bounds.p2].map(|p| if p > 0.0 { p } else { 1.0 })
}

/// The place of a shadow in phase space: the directions of its rods, and its momenta in SI units.
struct Place {
    directions: [Direction<f64>; 2],
    momenta: [f64; 2],
}

impl Place {
    /// Returns the place of a shadow; it is NaN if that has no motion.
    fn of(run: &Run<Motion32>) -> Self {
        const NAN: f64 = f64::NAN;
        run.motion.as_ref().map_or(
            Self {
                directions: [[NAN; 2]; 2],
                momenta: [NAN; 2],
            },
            |motion| Self {
                directions: motion.directions(),
                momenta: motion.momenta(),
            },
        )
    }

    /// Returns the difference from another place in the order a1, a2, p1, p2, with the momenta in
    /// units of `scales`. The difference of an angle is given by its sine, or by 1 or -1 if it is
    /// more than a right angle.
    fn minus(&self, other: &Self, scales: [f64; 2]) -> [f64; 4] {
        let angle = |[sin, cos]: Direction<f64>, [sin0, cos0]: Direction<f64>| {
            let sine = sin * cos0 - cos * sin0;
            if cos * cos0 + sin * sin0 < 0.0 {
                f64::copysign(1.0, sine)
            } else {
                sine
            }
        };
        let [rod1, rod2] = self.directions;
        let [other1, other2] = other.directions;
        let [p1, p2] = self.momenta;
        let [other_p1, other_p2] = other.momenta;
        let [s1, s2] = scales;
        [
            angle(rod1, other1),
            angle(rod2, other2),
            (p1 - other_p1) / s1,
            (p2 - other_p2) / s2,
        ]
    }
}

/// Returns the sum of `fine` and `difference`. The momenta of `fine` and of the result are in SI
/// units, those of `difference` in units of `scales`, which are the last argument.
fn beside(fine: &State<f64>, difference: [f64; 4], [s1, s2]: [f64; 2]) -> State<f64> {
    let [a1, a2, p1, p2] = difference;
    State {
        a1: fine.a1 + a1,
        a2: fine.a2 + a2,
        p1: fine.p1 + s1 * p1,
        p2: fine.p2 + s2 * p2,
    }
}

/// Returns the lower triangular matrix L with L L^T = D D^T + `variance` I, where `rows` are those
/// of D. If that matrix is singular, or almost, the squares of diagonal elements of L are increased
/// to `least`, and L L^T is larger.
fn cholesky(rows: &Matrix, variance: f64, least: f64) -> Matrix {
    let mut factor = [[0.0; 4]; 4];
    for i in 0..4 {
        for j in 0..=i {
            // The elements of row i from j on are still 0, so that only columns before j count.
            let rest = dot(&rows[i], &rows[j]) - dot(&factor[i], &factor[j]);
            factor[i][j] = if i == j {
                libm::sqrt(f64::max(rest + variance, least))
            } else {
                rest / factor[j][j]
            };
        }
    }
    factor
}

/// Returns the scalar product of two rows.
#[inline(never)] // 3 KB more flash on an M3 without.
fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests;
