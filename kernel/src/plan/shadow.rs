//! Shadows: motions close to another one, which measure the growth of its small errors.
//!
//! A run in 64 bits makes a small rounding error in every frame. The motion carries these errors
//! on, and in a chaotic motion they grow exponentially. As long as they are small they are carried
//! on linearly, so that larger distances grow in the same way. A shadow is a motion at such a
//! distance, which may be computed in 32 bits and in coarse steps.
//!
//! The error of a run is a random vector in phase space (a1, a2, p1, p2), with a covariance matrix
//! P. Four shadows represent it: if D is the matrix of their differences from a fifth one, the
//! central shadow, then
//!
//! ```text
//! P = unit^2 D D^T + q^2 n I
//! ```
//!
//! Here q is the rounding error of a frame, and n is the number of frames since the shadows were
//! last prepared. The unit is the rounding error, in rad, that a distance of 1 rad stands for. The
//! expected displacement of a bob is the root of the sum of the squares of the displacements that
//! the four shadows show.
//!
//! When a distance has become four times as large, or some time has passed, the shadows are
//! prepared anew at the motion. Their differences are the columns of the Cholesky factor of P. This
//! adds the rounding errors of the last frames, in all directions. They have to be added soon: a
//! direction in phase space that shrinks at first may grow most later. The error of a later frame
//! may then become a hundred times as large as the growth since the start suggests.

use super::candidate::{distance, greater};
use super::cost::{Costs, Stepping};
use super::problem::Problem;
use super::trial::Run;
use crate::error::Error;
use crate::methods::any::DrawnMotion32;
use crate::pendulum::{Parameters, State};

/// The distance of the farthest shadow when the shadows are prepared, rad.
const NEAR: f64 = 1.0 / (1 << 13) as f64;
/// The distance at which the shadows are prepared anew, rad.
const FAR: f32 = 4.0 * NEAR as f32;
/// The growth of the errors after which new rounding errors hardly matter, and the distance at which
/// the shadows are prepared anew from then on, rad.
const GROWN: f32 = 1e5;
const FARTHEST: f32 = 1.0 / (1 << 6) as f32;
/// The phase of the fastest motion after which the shadows are prepared anew, rad, and the smallest
/// number of frames. A heavy bob 2 allows so fast a motion that this phase may pass in a frame.
const PHASE: f64 = 32.0;
const FEWEST_FRAMES: u32 = 32;
/// The smallest diagonal element of the Cholesky factor, as a share of the largest standard
/// deviation, so that it is never 0. The numbers of the shadows do not show smaller differences.
const SMALLEST: f64 = 1.0 / (1 << 26) as f64;

/// The number of shadows: the central one, and one for each dimension of phase space.
const SHADOWS: usize = 5;

/// The rounding error of a run in 64 bits, rad: of its start, and of each step. They are added as
/// squares from frame to frame.
///
/// The values are measured, as is the next one. Of 500 motions from high starts, the errors came to
/// at most 0.9 of the bound; the median was 0.05. Test `plan_study` checks the bound against the
/// exact motion.
const ROUNDING: [f32; 2] = [6e-16, 2.5e-17];

/// The factor on the rounding error of a step if l1/l2 is not above 1/2 and at most 1. The method
/// then has different units for the rates of the two rods.
const UNLIKE_UNITS: f32 = 3.0;

/// The rows of a matrix. Its rows belong to a1, a2, p1 and p2, in units of [`scales`].
type Matrix = [[f64; 4]; 4];

/// A central motion and four others close to it.
///
/// For each frame, [`prepare`](Self::prepare) is called until it returns false, all
/// [`runs`](Self::runs) are advanced to the frame, and it is [compared](Self::compare).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shadows {
    /// The central shadow and the other four.
    runs: [Run<DrawnMotion32>; SHADOWS],
    /// The rounding error that a distance stands for, rad per rad.
    unit: f32,
    /// The number of frames since the shadows were prepared.
    frames: u32,
    /// The number of frames after which they are prepared anew.
    most_frames: u32,
    /// True if the shadows must be prepared anew.
    is_due: bool,
    /// True after the first frame has been compared.
    has_begun: bool,
    /// The fastest rate that the energy allows, rad/s.
    rate: f32,
    /// The rounding error of one frame, rad.
    of_frame: f32,
}

impl Shadows {
    /// Creates the shadows of a motion in 64 bits that makes `steps` steps per frame. The shadows
    /// themselves are computed by `stepping`. `admissible` is the [longest step that resolves the
    /// motion](super::cost::admissible_step), s; infinite if nothing can move.
    ///
    /// No motion is prepared yet. A pendulum that is refused is reported by
    /// [`prepare`](Self::prepare). So are a `stepping` that is not in 32 bits and one with 0 steps.
    pub fn new(stepping: Stepping, problem: &Problem, admissible: f64, steps: u32) -> Self {
        let rate = fastest_rate(admissible);
        let [of_start, of_step] = ROUNDING;
        let Parameters { l1, l2, .. } = problem.pendulum;
        let has_like_units = 0.5 * l2 < l1 && l1 <= l2;
        let unlike = if has_like_units { 1.0 } else { UNLIKE_UNITS };

        Self {
            runs: [Run::new(stepping); SHADOWS],
            unit: of_start / NEAR as f32,
            frames: 0,
            most_frames: frames_between(rate, problem.rate),
            is_due: false,
            has_begun: false,
            rate: rate as f32,
            of_frame: unlike * of_step * steps as f32,
        }
    }

    /// Returns the cost of a frame of shadows that are computed by `stepping`, in the unit of
    /// `costs`. It includes a share of the preparations, if these are due by the phase.
    ///
    /// `admissible` is the [longest step that resolves the motion](super::cost::admissible_step),
    /// and `rate` is the number of frames per second.
    pub fn cost_of_frame(stepping: Stepping, admissible: f64, rate: u16, costs: &Costs) -> f32 {
        let between = frames_between(fastest_rate(admissible), rate);
        SHADOWS as f32 * costs.of_frame(stepping) + costs.preparation / between as f32
    }

    /// Returns the runs of all shadows. Some may not be prepared yet, or may have diverged.
    pub fn runs(&mut self) -> impl Iterator<Item = &mut Run<DrawnMotion32>> {
        self.runs.iter_mut()
    }

    /// Returns true after the first frame has been compared. Until then shadows are prepared at the
    /// start of the motion, and from then on at the present frame.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Returns true if the shadows must be prepared anew by [`prepare`](Self::prepare). Before the
    /// first frame is compared, they need not.
    pub fn must_prepare(&self) -> bool {
        self.is_due
    }

    /// Prepares one shadow close to a motion in the state `motion`, or all shadows anew, if that is
    /// due. The state is that of the fine run at the same frame, in SI units.
    ///
    /// Returns true if it has done either, and false if there is nothing to do. `problem` must be
    /// that of [`new`](Self::new); this is not checked.
    ///
    /// # Errors
    ///
    /// Returns the error of the method if it refuses the shadow on both sides of the motion; the
    /// shadows are unchanged then. A `motion` that is not finite is refused.
    pub fn prepare(&mut self, problem: &Problem, motion: &State<f64>) -> Result<bool, Error> {
        let scales = scales(&problem.pendulum, self.rate.into());
        if self.is_due {
            self.prepare_anew(motion, scales)?;
            return Ok(true);
        }

        // Select a shadow that is not prepared.
        let mut runs = self.runs.iter_mut().enumerate();
        let Some((number, run)) = runs.find(|(_, run)| run.motion.is_none()) else {
            return Ok(false);
        };

        // At the start both angles are rounded, and the momenta relative to their values.
        let [_, _, of_p1, of_p2] = scales;
        let shares = [1.0, 1.0, motion.p1 / of_p1, motion.p2 / of_p2];
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
            let start = beside(motion, difference(sign), scales);
            DrawnMotion32::new(method, &problem.pendulum, &start, dt)
        };
        run.motion = Some(prepared(1.0).or_else(|_| prepared(-1.0))?);
        Ok(true)
    }

    /// Prepares all shadows anew at the motion in the state `motion`, and adds the rounding errors
    /// since they were last prepared to their differences.
    fn prepare_anew(&mut self, motion: &State<f64>, scales: [f64; 4]) -> Result<(), Error> {
        // The differences, a row for each dimension.
        let [center, others @ ..] = &mut self.runs;
        let center_state = center.motion.map_or(*motion, |motion| motion.state());
        let mut rows = [[0.0; 4]; 4];
        for (column, run) in others.iter().enumerate() {
            if let Some(shadow) = &run.motion {
                let difference = difference(&shadow.state(), &center_state, scales);
                for (row, number) in rows.iter_mut().zip(difference) {
                    row[column] = number;
                }
            }
        }

        // The Cholesky factor, scaled so that the largest standard deviation is near.
        let added = f64::from(self.of_frame / self.unit);
        let variance = added * added * f64::from(self.frames);
        let largest = rows.iter().map(|row| dot(row, row)).fold(0.0, f64::max) + variance;
        let factor = cholesky(&rows, variance, SMALLEST * SMALLEST * largest);
        let deviation = libm::sqrt(largest);
        let scale = NEAR / deviation;
        self.unit *= (deviation / NEAR) as f32;

        // The central shadow at the motion itself, and the others at the columns of the factor.
        for (number, run) in self.runs.iter_mut().enumerate() {
            if let Some(shadow) = &mut run.motion {
                let difference = match number.checked_sub(1) {
                    Some(column) => factor.map(|row| scale * row[column % 4]),
                    None => [0.0; 4],
                };
                *shadow = shadow.started(&beside(motion, difference, scales))?;
            }
        }
        self.frames = 0;
        self.is_due = false;
        Ok(())
    }

    /// Returns the rounding error of all frames since the last preparation, without its growth,
    /// rad.
    fn of_frames(&self) -> f32 {
        self.of_frame * libm::sqrtf(self.frames as f32)
    }

    /// Compares the shadows with each other at a frame. Every frame after the start must be
    /// compared once, in order, because rounding errors add up. All steps towards it must have been
    /// made. Neither is checked. A shadow that is not prepared counts as diverged.
    ///
    /// Returns the largest rounding error that is expected of the motion in 64 bits, with the steps
    /// given to [`new`](Self::new), in units of the tolerance. `rods` are the lengths of the rods
    /// in the same unit. The result is NaN if the error is unknown: once a shadow has diverged.
    pub fn compare(&mut self, rods: [f32; 2]) -> f32 {
        self.has_begun = true;
        self.frames = self.frames.saturating_add(1);

        // The distances from the central shadow.
        let [center, others @ ..] = self.runs.each_mut().map(Run::frame);
        let mut farthest = 0.0;
        let mut squares = 0.0;
        for other in &others {
            farthest = greater(distance([1.0; 2], other, &center), farthest);
            let shown = distance(rods, other, &center);
            squares += shown * shown;
        }
        let [of_start, _] = ROUNDING;
        self.is_due = if self.unit * farthest > GROWN * of_start {
            farthest > FARTHEST
        } else {
            farthest > FAR || self.frames >= self.most_frames
        };

        let carried_on = self.unit * libm::sqrtf(squares);
        let [rod1, rod2] = rods;
        carried_on + self.of_frames() * (rod1 + rod2)
    }
}

/// Returns the fastest rate that the energy allows, rad/s: in four admissible steps it advances a
/// phase by a radian.
fn fastest_rate(admissible: f64) -> f64 {
    0.25 / admissible
}

/// Returns the number of frames after which shadows are prepared anew, at most. `rate` is the
/// fastest rate, rad/s, and `frames` the number of frames per second.
fn frames_between(rate: f64, frames: u16) -> u32 {
    let phase_passes = (PHASE / rate * f64::from(frames)) as u32;
    phase_passes.max(FEWEST_FRAMES)
}

/// Returns the units of the numbers of a state, in the order a1, a2, p1, p2: 1 rad, and the
/// momenta, kg m^2/s, of rods that turn at half the fastest `rate`, rad/s, or at 1 rad/s if nothing
/// can move.
fn scales(&Parameters { m1, m2, l1, l2, .. }: &Parameters<f64>, rate: f64) -> [f64; 4] {
    let half = if rate > 0.0 { 0.5 * rate } else { 1.0 };
    [1.0, 1.0, (m1 + m2) * l1 * l1 * half, m2 * l2 * l2 * half]
}

/// Returns `one` - `other` in the order a1, a2, p1, p2, with angles between -pi and pi, each divided
/// by its scale.
fn difference(one: &State<f64>, other: &State<f64>, scales: [f64; 4]) -> [f64; 4] {
    const TURN: f64 = 2.0 * core::f64::consts::PI;
    let turned = |angle: f64| angle - TURN * libm::rint(angle / TURN);
    let [s1, s2, s3, s4] = scales;
    [
        turned(one.a1 - other.a1) / s1,
        turned(one.a2 - other.a2) / s2,
        (one.p1 - other.p1) / s3,
        (one.p2 - other.p2) / s4,
    ]
}

/// Returns the state at a difference from `motion`, which is in units of `scales`.
fn beside(motion: &State<f64>, difference: [f64; 4], scales: [f64; 4]) -> State<f64> {
    let [by1, by2, by3, by4] = core::array::from_fn(|i| difference[i] * scales[i]);
    State {
        a1: motion.a1 + by1,
        a2: motion.a2 + by2,
        p1: motion.p1 + by3,
        p2: motion.p2 + by4,
    }
}

/// Returns the lower triangular matrix L with L L^T = D D^T + `variance` I, where `rows` are those
/// of D. The square of a diagonal element of L is at least `least`.
fn cholesky(rows: &Matrix, variance: f64, least: f64) -> Matrix {
    let mut factor = [[0.0; 4]; 4];
    for i in 0..4 {
        for j in 0..=i {
            // The elements of row i of the factor from j on are still 0.
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
mod tests {
    use super::*;
    use crate::pendulum::{Motion, Pendulum};
    use crate::table::Method;

    /// A motion in which the error of a frame after the first second grows 30 times as much as the
    /// growth since the start suggests.
    const PROBLEM: Problem = Problem {
        pendulum: Parameters {
            m1: 1.0,
            m2: 2.984898867826733,
            l1: 1.0,
            l2: 1.8673452819254164,
            g: 9.81,
        },
        start: Motion {
            a1: 2.2082918834551712,
            a2: 1.9751053641836052,
            w1: 0.0,
            w2: 0.0,
        },
        tolerance: 0.04,
        duration: 10.0,
        rate: 60,
    };
    /// The steps per frame of the exact motion, and of a shadow.
    const STEPS: u32 = 32;
    /// The largest difference between the error that the shadows show and the exact one, as a share
    /// of it, after the first frames. Before these, errors are not added at once.
    const DIFFERENCE: f64 = 0.4;
    const FIRST_FRAMES: u32 = 120;

    /// Returns the state after a frame.
    fn after_frame(pendulum: &Pendulum<f64>, start: &State<f64>) -> State<f64> {
        let dt = 1.0 / (f64::from(PROBLEM.rate) * f64::from(STEPS));
        let mut state = *start;
        for _ in 0..STEPS {
            state = pendulum.step(&state, dt);
        }
        state
    }

    /// Returns the Jacobian matrix of a frame, in units of `scales`, by central differences.
    fn jacobian(pendulum: &Pendulum<f64>, start: &State<f64>, scales: [f64; 4]) -> Matrix {
        const STEP: f64 = 1e-5;
        let columns: Matrix = core::array::from_fn(|j| {
            let [less, more] = [-STEP, STEP].map(|by| {
                let mut change = [0.0; 4];
                change[j] = by;
                after_frame(pendulum, &beside(start, change, scales))
            });
            difference(&more, &less, scales).map(|change| change / (2.0 * STEP))
        });
        core::array::from_fn(|i| columns.map(|column| column[i]))
    }

    /// Returns the root of the expected square of the distance of two frames, in units of the
    /// tolerance, if the covariance matrix of the error is `root` times its transpose.
    fn expected_distance(state: &State<f64>, root: &Matrix) -> f64 {
        let [l1, l2] = [PROBLEM.pendulum.l1, PROBLEM.pendulum.l2].map(|l| l / PROBLEM.tolerance);
        let [a1, a2, ..] = root;
        let bob1 = l1 * l1 * dot(a1, a1);
        let relative = l2 * l2 * dot(a2, a2);
        let cos = libm::cos(state.a1 - state.a2);
        let bob2 = bob1 + relative + 2.0 * l1 * l2 * cos * dot(a1, a2);
        libm::sqrt(bob1.max(relative).max(bob2))
    }

    /// The shadows show the rounding error that a random error of the start and of every frame
    /// causes. For this the covariance matrix is carried on by the Jacobian matrix of every frame.
    #[test]
    fn shadows_show_the_expected_error_of_roundings_in_all_frames() -> Result<(), Error> {
        let pendulum = Pendulum::new(&PROBLEM.pendulum)?;
        let mut state = pendulum.to_state(&PROBLEM.start);
        let stepping = Stepping {
            method: Method::Rk4Fixed32,
            steps: STEPS,
        };
        let admissible = pendulum.admissible_step(&state)?;
        let mut shadows = Shadows::new(stepping, &PROBLEM, admissible, 12);
        let scales = scales(&PROBLEM.pendulum, shadows.rate.into());
        let rods = [PROBLEM.pendulum.l1, PROBLEM.pendulum.l2].map(|l| l / PROBLEM.tolerance);

        // The error of the start, as a root of its covariance matrix.
        let [of_start, _] = ROUNDING.map(f64::from);
        let mut root = [[0.0; 4]; 4];
        root[0][0] = of_start;
        root[1][1] = of_start;

        for frame in 1..=PROBLEM.frames() {
            // Carry the error on by the Jacobian matrix, and add that of the frame.
            let columns = |row: [f64; 4]| {
                core::array::from_fn(|column| (0..4).map(|j| row[j] * root[j][column]).sum())
            };
            let carried_on = jacobian(&pendulum, &state, scales).map(columns);
            let variance = f64::from(shadows.of_frame).powi(2);
            root = cholesky(&carried_on, variance, variance);

            // Advance the shadows and the motion to the frame.
            while shadows.prepare(&PROBLEM, &state)? {}
            for run in shadows.runs() {
                run.motion.as_mut().expect("prepared").advance(STEPS);
            }
            state = after_frame(&pendulum, &state);
            let shown = f64::from(shadows.compare(rods.map(|rod| rod as f32)));

            // Compare the two.
            let expected = expected_distance(&state, &root);
            assert!(
                frame <= FIRST_FRAMES || (shown - expected).abs() < DIFFERENCE * expected,
                "frame {frame}: {shown} instead of {expected}"
            );
        }
        Ok(())
    }

    /// The product of the Cholesky factor with its transpose is D D^T + v I, to 1e-14. If that is
    /// singular, the factor is finite, and its diagonal elements have the least square.
    #[test]
    fn cholesky_factor_is_a_root_of_the_matrix() {
        let rows = [
            [1.0, 0.0, 0.1, 0.0],
            [2.0, 1.5, -0.7, 0.0],
            [-1.0, 0.3, 1.0, 0.0],
            [0.5, -0.2, 0.0, 0.4],
        ];
        let factor = cholesky(&rows, 0.25, 0.0);
        for i in 0..4 {
            for j in 0..4 {
                let variance = if i == j { 0.25 } else { 0.0 };
                let expected = dot(&rows[i], &rows[j]) + variance;
                let product = dot(&factor[i], &factor[j]);
                assert!(
                    (product - expected).abs() < 1e-14,
                    "{i} {j}: {product} {expected}"
                );
                assert!(j <= i || factor[i][j] == 0.0);
            }
        }

        let singular = cholesky(&rows.map(|[first, ..]| [first, 0.0, 0.0, 0.0]), 0.0, 1e-6);
        assert_eq!([1, 2, 3].map(|i| singular[i][i]), [1e-3; 3]);
    }
}
