//! Shadows: motions close to another one, which measure how its rounding errors grow.
//!
//! A run in 64 bits makes a small rounding error in every frame. The motion propagates these errors
//! and, if it is chaotic, they grow exponentially. Small errors are propagated linearly. Larger
//! distances therefore grow by the same factors, as long as they stay below about 2^-6 rad, and
//! such distances can be computed in 32 bits and in coarse steps. A *shadow* is a motion at such a
//! distance.
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
//! where n is the number of frames since the shadows were last started, and u is the error that a
//! distance of 1 rad stands for. All five have about the same truncation error, so that it cancels
//! in D. At the start D is diagonal: both angles are rounded, and the momenta relative to their
//! values.
//!
//! The shadows are started again when the farthest one is four times as far as at first, or after
//! some time:
//!
//! 1. Compute P, and its Cholesky factor L, so that L L^T = P. Any D with the same u^2 D D^T
//!    represents the same errors.
//! 2. Choose u such that the largest standard deviation in L/u is [`NEAR`].
//! 3. Start the central shadow at the state of the fine run of the reference, and the others beside
//!    it at the columns of L/u. Set n to 0.
//!
//! This adds the errors of the last n frames, in all directions. It must happen often at first: a
//! direction that shrinks at first may be the one that grows most later. An error of a later frame
//! then grows a hundred times as much as an error of the start. When errors have grown by 1e5, new
//! ones hardly matter, and the shadows are started again only where distances are no longer small,
//! or after a long time.
//!
//! # The result
//!
//! The error of a frame is u times the root of the sum of the squares of the four displacements,
//! plus q sqrt(n) times the length of both rods for the last n frames. Since q is larger than the
//! rounding errors, this is used as an upper bound.

use super::candidate::{distance, greater};
use super::cost::{Costs, Stepping};
use super::problem::Problem;
use super::trial::Run;
use crate::error::Error;
use crate::methods::any::DrawnMotion32;
use crate::pendulum::{Parameters, Pendulum, State};

/// The largest standard deviation that the shadows represent when they are started again, in units
/// of [`scales`]. At the start, the distance of a shadow that differs in an angle, rad.
const NEAR: f64 = 1.0 / (1 << 13) as f64;
/// The distance at which the shadows are started again, rad.
const FAR: f32 = 4.0 * NEAR as f32;
/// The growth of the errors after which new rounding errors hardly matter: the ratio to the larger
/// one of the errors of the start and of a frame.
const GROWN: f32 = 1e5;
/// The distance at which the shadows are started again after that growth, rad.
const FARTHEST: f32 = 1.0 / (1 << 6) as f32;
/// The factor on the number of frames between two starts after that growth.
const SELDOM: u32 = 16;
/// The phase, at the fastest rate, after which the shadows are started again, rad.
const PHASE: f64 = 32.0;
/// The smallest number of frames between two starts that are due by the phase. With a heavy bob 2
/// that phase may pass in a frame.
const FEWEST_FRAMES: u32 = 32;
/// The smallest diagonal element of the Cholesky factor, as a share of the largest standard
/// deviation. The numbers of 32 bits do not show smaller differences.
const SMALLEST: f64 = 1.0 / (1 << 26) as f64;

/// The number of shadows: the central one, and one for each dimension of phase space.
const SHADOWS: usize = 5;

/// The assumed standard deviation of the rounding error of a run in 64 bits: of the start, rad, and
/// of each step. The errors of the steps of a frame add up linearly, those of different frames as
/// squares.
///
/// The values are measured, and larger than the errors: with four fifths of them, one of 2,000
/// plans for high starts had an error before its horizon of 1.09 tolerances, and no other one more
/// than 1. Test `plan_study` checks the bound against the exact motion.
const ROUNDING: [f32; 2] = [1.2e-15, 5e-17];

/// The factor on the rounding error of a step unless 1/2 < l1/l2 <= 1. Outside that range
/// [`Fixed64`](crate::Fixed64) has different units for the rates of the two rods. Measured, too.
const UNLIKE_UNITS: f32 = 6.0;

/// The rows of a matrix, which belong to a1, a2, p1 and p2 in units of [`scales`].
type Matrix = [[f64; 4]; 4];

/// A central motion and four others close to it.
///
/// For each frame, [`prepare`](Self::prepare) is called until it returns false, all
/// [`runs`](Self::runs) are advanced to the frame, and the frame is [compared](Self::compare).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shadows {
    /// The central shadow and the other four.
    runs: [Run<DrawnMotion32>; SHADOWS],
    /// u: the error that a distance of 1 rad stands for, rad.
    unit: f32,
    /// n: the number of frames since the shadows were started.
    frames: u32,
    /// The number of frames after which they are started again.
    most_frames: u32,
    /// True if the shadows must be started again.
    is_due: bool,
    /// True after the first frame has been compared.
    has_begun: bool,
    /// q: the rounding error of one frame, rad.
    frame_error: f32,
}

impl Shadows {
    /// Creates the shadows of a motion in 64 bits that makes `steps` steps per frame. The shadows
    /// themselves are computed by `stepping`. `admissible` is the [longest step that resolves the
    /// motion](super::cost::admissible_step), s; infinite if nothing can move.
    ///
    /// No motion is prepared yet. [`prepare`](Self::prepare) reports a pendulum that is refused,
    /// and a `stepping` that is not in 32 bits or has 0 steps.
    pub fn new(stepping: Stepping, problem: &Problem, admissible: f64, steps: u32) -> Self {
        let [of_start, of_step] = ROUNDING;
        let Parameters { l1, l2, .. } = problem.pendulum;
        let has_like_units = 0.5 * l2 < l1 && l1 <= l2;
        let unlike = if has_like_units { 1.0 } else { UNLIKE_UNITS };

        Self {
            runs: [Run::new(stepping); SHADOWS],
            // A distance of NEAR stands for the rounding error of the start.
            unit: of_start / NEAR as f32,
            frames: 0,
            most_frames: frames_between(admissible, problem.rate),
            is_due: false,
            has_begun: false,
            frame_error: unlike * of_step * steps as f32,
        }
    }

    /// Returns the cost of a frame of shadows that are computed by `stepping`, in the unit of
    /// `costs`. It includes the share of a frame in the starts that are due by the phase, but not
    /// those that are due by distance.
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
    pub fn runs(&mut self) -> impl Iterator<Item = &mut Run<DrawnMotion32>> {
        self.runs.iter_mut()
    }

    /// Returns true after the first frame has been compared. Until then shadows start at the start
    /// of the motion, and from then on at the present frame.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// Returns true if [`prepare`](Self::prepare) must start the shadows again. Returns false
    /// before the first frame is compared, although they may not be prepared yet.
    pub fn must_prepare(&self) -> bool {
        self.is_due
    }

    /// Prepares one shadow beside the state `fine`, or starts all shadows again there, if that is
    /// due. `fine` is the state of the fine run at the same frame, in SI units.
    ///
    /// Returns true if it has done either, and false if there is nothing to do. `problem` must be
    /// that of [`new`](Self::new); this is not checked.
    ///
    /// # Errors
    ///
    /// Returns the error of the method if it refuses the shadow on both sides of `fine`; the
    /// shadows are unchanged then. If they are started again, it refuses only states that are not
    /// finite, and the shadows are meaningless then.
    pub fn prepare(&mut self, problem: &Problem, fine: &State<f64>) -> Result<bool, Error> {
        let scales = scales(problem)?;
        if self.is_due {
            self.start_again(fine, scales)?;
            return Ok(true);
        }

        // Select a shadow that is not prepared.
        let mut runs = self.runs.iter_mut().enumerate();
        let Some((number, run)) = runs.find(|(_, run)| run.motion.is_none()) else {
            return Ok(false);
        };

        // At the start both angles are rounded, and the momenta relative to their values. Run 0 is
        // the central one, and run i + 1 differs in number i of the state.
        let [_, _, of_p1, of_p2] = scales;
        let shares = [1.0, 1.0, fine.p1 / of_p1, fine.p2 / of_p2];
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
            let start = beside(fine, difference(sign), scales);
            DrawnMotion32::new(method, &problem.pendulum, &start, dt)
        };
        run.motion = Some(prepared(1.0).or_else(|_| prepared(-1.0))?);
        Ok(true)
    }

    /// Starts all shadows again beside the state `fine`, and adds the rounding errors of the frames
    /// since the last start to their differences.
    fn start_again(&mut self, fine: &State<f64>, scales: [f64; 4]) -> Result<(), Error> {
        // Collect the differences from the central shadow: D, a row for each number of the state.
        let [center, others @ ..] = &mut self.runs;
        let center = center.motion.map_or(*fine, |motion| motion.state());
        let mut rows = [[0.0; 4]; 4];
        for (column, run) in others.iter().enumerate() {
            if let Some(shadow) = &run.motion {
                let difference = difference(&shadow.state(), &center, scales);
                for (row, number) in rows.iter_mut().zip(difference) {
                    row[column] = number;
                }
            }
        }

        // Compute the variance that the last frames add, in units of a distance, and L/u for the
        // present u.
        let added = f64::from(self.frame_error / self.unit);
        let variance = added * added * f64::from(self.frames);
        let largest = rows.iter().map(|row| dot(row, row)).fold(0.0, f64::max) + variance;
        let factor = cholesky(&rows, variance, SMALLEST * SMALLEST * largest);

        // L is scaled such that the largest standard deviation is near.
        let deviation = libm::sqrt(largest);
        let scale = NEAR / deviation;

        // Start the central shadow at the state itself, and the others at the columns.
        for (number, run) in self.runs.iter_mut().enumerate() {
            if let Some(shadow) = &mut run.motion {
                let difference = match number.checked_sub(1) {
                    // The remainder changes nothing; it avoids a check of the index.
                    Some(column) => factor.map(|row| scale * row[column % 4]),
                    None => [0.0; 4],
                };
                *shadow = shadow.started(&beside(fine, difference, scales))?;
            }
        }

        // Change u by the inverse factor, so that the errors stay the same.
        self.unit *= (deviation / NEAR) as f32;
        self.frames = 0;
        self.is_due = false;
        Ok(())
    }

    /// Returns q sqrt(n): the rounding error of all frames since the last start, without its
    /// growth, rad.
    fn recent_error(&self) -> f32 {
        self.frame_error * libm::sqrtf(self.frames as f32)
    }

    /// Compares the shadows with each other at a frame. Every frame after the start must be
    /// compared once, in order, because rounding errors add up. All steps towards it must have been
    /// made. Neither is checked. A shadow that is not prepared counts as diverged.
    ///
    /// Returns an upper bound of the rounding error of a motion in 64 bits, with as many steps as
    /// [`new`](Self::new) was told, in units of the tolerance. It is exceeded only in rare cases.
    /// `rods` are the lengths of the rods in the same unit. The result is NaN if the error is
    /// unknown: once a shadow has diverged.
    pub fn compare(&mut self, rods: [f32; 2]) -> f32 {
        self.has_begun = true;
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

        // Start again when distances are no longer small or when new errors must be added. Once the
        // errors have grown, new ones hardly matter.
        let [of_start, _] = ROUNDING;
        let has_grown = self.unit * farthest > GROWN * greater(of_start, self.frame_error);
        self.is_due = if has_grown {
            farthest > FARTHEST || self.frames >= self.most_frames.saturating_mul(SELDOM)
        } else {
            farthest > FAR || self.frames >= self.most_frames
        };

        // Add the errors of the last frames, which the shadows do not contain yet. Bob 2 moves by
        // at most the sum of the displacements along both rods.
        let [rod1, rod2] = rods;
        self.unit * libm::sqrtf(squares) + self.recent_error() * (rod1 + rod2)
    }
}

/// Returns the number of frames after which the shadows are started again, at most, at `frame_rate`
/// frames per second. In four `admissible` steps, s, a phase advances by a radian at the fastest
/// rate that the energy allows.
fn frames_between(admissible: f64, frame_rate: u16) -> u32 {
    let frames = PHASE * 4.0 * admissible * f64::from(frame_rate);
    (frames as u32).max(FEWEST_FRAMES)
}

/// Returns the units of the numbers of a state, in the order a1, a2, p1, p2: 1 rad, and the largest
/// momenta that the energy allows ([`Bounds`](crate::Bounds)), kg m^2/s, or 1 if nothing can move.
/// Rounding errors of fixed point are relative to these.
///
/// Refuses a pendulum that [`Pendulum::new`] refuses.
fn scales(problem: &Problem) -> Result<[f64; 4], Error> {
    let pendulum = Pendulum::new(&problem.pendulum)?;
    let bounds = pendulum.bounds(&pendulum.to_state(&problem.start));
    let [p1, p2] = [bounds.p1, bounds.p2].map(|p| if p > 0.0 { p } else { 1.0 });
    Ok([1.0, 1.0, p1, p2])
}

/// Returns (`one` - `other`)/`scales` in the order a1, a2, p1, p2. Differences of angles are first
/// reduced to between -pi and pi.
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

/// Returns the state at a difference from `fine`, which is in units of `scales`.
fn beside(fine: &State<f64>, difference: [f64; 4], scales: [f64; 4]) -> State<f64> {
    let [by1, by2, by3, by4] = core::array::from_fn(|i| difference[i] * scales[i]);
    State {
        a1: fine.a1 + by1,
        a2: fine.a2 + by2,
        p1: fine.p1 + by3,
        p2: fine.p2 + by4,
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
mod tests {
    use super::*;
    use crate::pendulum::{Motion, Pendulum};
    use crate::table::Method;

    /// A pendulum with a bob 1 of 1 kg and a rod 1 of 1 m, at rest at the start, and the steps per
    /// frame that resolve its motion.
    struct Case {
        m2: f64,
        l2: f64,
        angles: [f64; 2],
        steps: u32,
        /// The smallest and the largest ratio of the error that the shadows show to the exact one.
        ratios: [f64; 2],
    }

    /// In the first motion an error of the second second grows 30 times as much as one of the
    /// start. The others have a heavy bob 2, in small and in large oscillations, and unlike rods.
    const CASES: [Case; 5] = [
        Case {
            m2: 2.984898867826733,
            l2: 1.8673452819254164,
            angles: [2.2082918834551712, 1.9751053641836052],
            steps: 32,
            ratios: [0.8, 1.5],
        },
        Case {
            m2: 1000.0,
            l2: 1.0,
            angles: [0.05, 0.05],
            steps: 128,
            ratios: [0.8, 2.2],
        },
        Case {
            m2: 100.0,
            l2: 1.0,
            angles: [1.0, 1.5],
            steps: 128,
            ratios: [0.25, 6.0],
        },
        Case {
            m2: 1.0,
            l2: 0.1,
            angles: [2.0, 2.0],
            steps: 128,
            ratios: [0.5, 1.5],
        },
        Case {
            m2: 1.0,
            l2: 10.0,
            angles: [2.0, 2.0],
            steps: 64,
            ratios: [0.4, 1.5],
        },
    ];

    impl Case {
        fn problem(&self) -> Problem {
            let [a1, a2] = self.angles;
            Problem {
                pendulum: Parameters {
                    m1: 1.0,
                    m2: self.m2,
                    l1: 1.0,
                    l2: self.l2,
                    g: 9.81,
                },
                start: Motion::at_rest(a1, a2),
                tolerance: 0.04,
                duration: 8.0,
                rate: 60,
            }
        }

        /// Returns the state after a frame.
        fn after_frame(&self, pendulum: &Pendulum<f64>, start: &State<f64>) -> State<f64> {
            let dt = 1.0 / (60.0 * f64::from(self.steps));
            let mut state = *start;
            for _ in 0..self.steps {
                state = pendulum.step(&state, dt);
            }
            state
        }

        /// Returns the Jacobian matrix of a frame, in units of `scales`, by central differences.
        fn jacobian(
            &self,
            pendulum: &Pendulum<f64>,
            start: &State<f64>,
            scales: [f64; 4],
        ) -> Matrix {
            const STEP: f64 = 1e-6;
            let columns: Matrix = core::array::from_fn(|j| {
                let [less, more] = [-STEP, STEP].map(|by| {
                    let mut change = [0.0; 4];
                    change[j] = by;
                    self.after_frame(pendulum, &beside(start, change, scales))
                });
                difference(&more, &less, scales).map(|change| change / (2.0 * STEP))
            });
            core::array::from_fn(|i| columns.map(|column| column[i]))
        }
    }

    /// The number of frames after which the two errors are compared. At first the shadows lag
    /// behind, because errors are only added when they are started again.
    const FIRST_FRAMES: u32 = 120;
    /// The steps per frame of the run in 64 bits, which is only assumed.
    const FINE_STEPS: u32 = 12;

    /// Returns the root of the expected square of the distance of two frames, in the unit of
    /// `rods`, if the covariance matrix of the error is `root` times its transpose.
    fn expected_distance([l1, l2]: [f64; 2], state: &State<f64>, root: &Matrix) -> f64 {
        let [a1, a2, ..] = root;
        let bob1 = l1 * l1 * dot(a1, a1);
        let relative = l2 * l2 * dot(a2, a2);
        let cos = libm::cos(state.a1 - state.a2);
        let bob2 = bob1 + relative + 2.0 * l1 * l2 * cos * dot(a1, a2);
        libm::sqrt(bob1.max(relative).max(bob2))
    }

    /// The shadows show the rounding error that a random error of the start and of every frame
    /// causes. The test propagates the covariance matrix by the Jacobian matrix of every frame.
    #[test]
    fn shadows_show_the_expected_error_of_roundings_in_all_frames() -> Result<(), Error> {
        for case in &CASES {
            let problem = case.problem();
            let pendulum = Pendulum::new(&problem.pendulum)?;
            let mut state = pendulum.to_state(&problem.start);
            let stepping = Stepping {
                method: Method::Rk4Fixed32,
                steps: case.steps,
            };
            let admissible = pendulum.admissible_step(&state)?;
            let mut shadows = Shadows::new(stepping, &problem, admissible, FINE_STEPS);
            let scales = scales(&problem)?;
            let rods = [problem.pendulum.l1, problem.pendulum.l2].map(|l| l / problem.tolerance);

            // Begin with a root of the covariance matrix of the start. The momenta are exactly 0.
            let [of_start, _] = ROUNDING.map(f64::from);
            let mut root = [[0.0; 4]; 4];
            root[0][0] = of_start;
            root[1][1] = of_start;

            for frame in 1..=problem.frames() {
                // Propagate the error by the Jacobian matrix, and add that of the frame.
                let columns = |row: [f64; 4]| {
                    core::array::from_fn(|column| (0..4).map(|j| row[j] * root[j][column]).sum())
                };
                let propagated = case.jacobian(&pendulum, &state, scales).map(columns);
                let variance = f64::from(shadows.frame_error).powi(2);
                root = cholesky(&propagated, variance, variance);

                // Advance the shadows and the motion to the frame.
                while shadows.prepare(&problem, &state)? {}
                for run in shadows.runs() {
                    run.motion.as_mut().expect("prepared").advance(case.steps);
                }
                state = case.after_frame(&pendulum, &state);
                let shown = f64::from(shadows.compare(rods.map(|rod| rod as f32)));

                // Compare the two.
                let expected = expected_distance(rods, &state, &root);
                let [least, most] = case.ratios.map(|ratio| ratio * expected);
                assert!(
                    frame <= FIRST_FRAMES || least < shown && shown < most,
                    "m2 = {}, l2 = {}, frame {frame}: {shown} instead of {expected}",
                    case.m2,
                    case.l2
                );
            }
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
