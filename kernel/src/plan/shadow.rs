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
use crate::methods::any::DrawnMotion32;
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
/// 2,000 high starts, before a horizon that rounding ends, was 0.63 tolerances. Test `plan_study`
/// checks the bound against the exact motion.
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
    runs: [Run<DrawnMotion32>; SHADOWS],
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
    pub fn runs(&mut self) -> impl Iterator<Item = &mut Run<DrawnMotion32>> {
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
            DrawnMotion32::new(method, &problem.pendulum, &start, dt)
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
                let started = shadow.restart(&beside(fine, difference, scales));
                if started.is_err() {
                    self.unit = f32::NAN;
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
    fn of(run: &Run<DrawnMotion32>) -> Self {
        const NAN: f64 = f64::NAN;
        run.motion.as_ref().map_or(
            Self {
                directions: [[NAN; 2]; 2],
                momenta: [NAN; 2],
            },
            |motion| Self {
                directions: motion.directions_in(),
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
mod tests {
    use super::*;
    use crate::pendulum::Motion;

    /// A pendulum with a bob 1 of 1 kg and a rod 1 of 1 m, and its start.
    struct Case {
        m2: f64,
        l2: f64,
        /// Two angles, rad, and two angular velocities, rad/s.
        start: [f64; 4],
        /// True if fixed point refuses the usual steps of the shadows as too long.
        needs_finer_steps: bool,
        /// The smallest and the largest ratio of the error that the shadows show to the exact one.
        ratios: [f64; 2],
    }

    /// In the first motion an error of the second second grows 30 times as much as one of the
    /// start. The others have a heavy bob 2, in small and in large oscillations, unlike rods, a
    /// light bob 2 whose shadows need finer steps in fixed point, and a start in motion.
    const CASES: [Case; 7] = [
        Case {
            m2: 2.984898867826733,
            l2: 1.8673452819254164,
            start: [2.2082918834551712, 1.9751053641836052, 0.0, 0.0],
            needs_finer_steps: false,
            ratios: [0.8, 1.3],
        },
        Case {
            m2: 1000.0,
            l2: 1.0,
            start: [0.05, 0.05, 0.0, 0.0],
            needs_finer_steps: false,
            ratios: [0.8, 1.8],
        },
        Case {
            m2: 100.0,
            l2: 1.0,
            start: [1.0, 1.5, 0.0, 0.0],
            needs_finer_steps: false,
            ratios: [0.2, 10.0],
        },
        Case {
            m2: 1.0,
            l2: 0.1,
            start: [2.0, 2.0, 0.0, 0.0],
            needs_finer_steps: false,
            ratios: [0.7, 2.2],
        },
        Case {
            m2: 1.0,
            l2: 10.0,
            start: [2.0, 2.0, 0.0, 0.0],
            needs_finer_steps: false,
            ratios: [0.7, 1.4],
        },
        Case {
            m2: 0.05,
            l2: 10.0,
            start: [2.5, 2.5, 0.0, 0.0],
            needs_finer_steps: true,
            ratios: [0.45, 1.3],
        },
        Case {
            m2: 0.5,
            l2: 0.7,
            start: [0.5, 1.0, 6.0, -9.0],
            needs_finer_steps: false,
            ratios: [0.65, 1.2],
        },
    ];

    impl Case {
        fn problem(&self) -> Problem {
            let [a1, a2, w1, w2] = self.start;
            Problem {
                pendulum: Parameters {
                    m1: 1.0,
                    m2: self.m2,
                    l1: 1.0,
                    l2: self.l2,
                    g: 9.81,
                },
                start: Motion { a1, a2, w1, w2 },
                tolerance: 0.04,
                duration: 8.0,
                rate: 60,
            }
        }

        /// Returns the state after a frame, in steps of at most an eighth of the admissible step.
        fn after_frame(&self, pendulum: &Pendulum<f64>, start: &State<f64>) -> State<f64> {
            let longest = pendulum.admissible_step(start).expect("a motion") / 8.0;
            let steps = steps_to_frame(Method::Rk4F64, 60, longest);
            let dt = 1.0 / (60.0 * f64::from(steps));
            (0..steps).fold(*start, |state, _| pendulum.step(&state, dt))
        }

        /// Returns the Jacobian matrix of a frame, in units of `scales`, by central differences.
        fn jacobian(
            &self,
            pendulum: &Pendulum<f64>,
            start: &State<f64>,
            scales: [f64; 2],
        ) -> Matrix {
            const STEP: f64 = 1e-6;
            let columns: Matrix = core::array::from_fn(|j| {
                let [less, more] = [-STEP, STEP].map(|by| {
                    let mut change = [0.0; 4];
                    change[j] = by;
                    self.after_frame(pendulum, &beside(start, change, scales))
                });
                let [s1, s2] = scales;
                let change = [
                    more.a1 - less.a1,
                    more.a2 - less.a2,
                    (more.p1 - less.p1) / s1,
                    (more.p2 - less.p2) / s2,
                ];
                change.map(|change| change / (2.0 * STEP))
            });
            core::array::from_fn(|i| columns.map(|column| column[i]))
        }
    }

    /// The number of frames after which the two errors are compared. At first the shadows lag
    /// behind, because errors are only added when they are restarted.
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

    /// Returns the smallest and the largest ratio of the error that shadows by `method` show to the
    /// error that random errors of the start and of every frame cause. The covariance matrix of the
    /// latter is propagated by the Jacobian matrix of every frame.
    fn ratios(case: &Case, method: Method) -> Result<[f64; 2], Error> {
        let problem = case.problem();
        let pendulum = Pendulum::new(&problem.pendulum)?;
        let mut state = pendulum.to_state(&problem.start);
        let rods = [problem.pendulum.l1, problem.pendulum.l2].map(|l| l / problem.tolerance);

        // Prepare the shadows.
        let scales = scales(&pendulum, &state);
        let admissible = pendulum.admissible_step(&state)?;
        let stepping = Shadows::stepping(method, problem.rate, admissible);
        let mut shadows = Shadows::new(stepping, &problem, scales, admissible, FINE_STEPS);
        while !shadows.are_prepared() {
            shadows.prepare(&problem, &state)?;
        }
        let has_finer_steps = shadows.runs[0].stepping != stepping;
        assert_eq!(
            has_finer_steps,
            case.needs_finer_steps && method == Method::Rk4Fixed32
        );

        // Begin with a root of the covariance matrix of the start. The shadows represent the same.
        let [of_start, _] = ROUNDING.map(f64::from);
        let mut root = [[0.0; 4]; 4];
        let [s1, s2] = scales;
        for (i, share) in [1.0, 1.0, state.p1 / s1, state.p2 / s2]
            .into_iter()
            .enumerate()
        {
            root[i][i] = of_start * share;
        }
        let [center, others @ ..] = shadows.runs.each_ref().map(Place::of);
        for (column, other) in others.iter().enumerate() {
            for (row, difference) in other.minus(&center, scales).into_iter().enumerate() {
                let shown = f64::from(shadows.unit) * difference;
                assert!(
                    (shown - root[row][column]).abs() < 0.01 * of_start,
                    "{row} {column}: {shown} {root:?}"
                );
            }
        }

        let mut ratios = [f64::INFINITY, 0.0];
        for frame in 1..=problem.frames() {
            // Propagate the error by the Jacobian matrix, and add that of the frame.
            let columns = |row: [f64; 4]| {
                core::array::from_fn(|column| (0..4).map(|j| row[j] * root[j][column]).sum())
            };
            let propagated = case.jacobian(&pendulum, &state, scales).map(columns);
            let variance = f64::from(shadows.frame_error).powi(2);
            root = cholesky(&propagated, variance, variance);

            // Advance the shadows and the motion to the frame.
            if shadows.is_due() {
                shadows.restart(&state);
            }
            for run in shadows.runs() {
                let steps = run.stepping.steps;
                run.motion.as_mut().expect("prepared").advance(steps);
            }
            state = case.after_frame(&pendulum, &state);
            let shown = f64::from(shadows.compare(rods.map(|rod| rod as f32)));

            // Compare the two.
            let ratio = shown / expected_distance(rods, &state, &root);
            assert!(ratio.is_finite(), "frame {frame}: {shown}");
            if frame > FIRST_FRAMES {
                let [least, most] = ratios;
                ratios = [least.min(ratio), most.max(ratio)];
            }
        }
        Ok(ratios)
    }

    /// In small oscillations the errors hardly grow, so that the shadows are restarted by the phase
    /// only. Over ten restarts, the estimated cost of a frame is right to a hundredth.
    #[test]
    fn estimated_cost_is_that_of_all_steps_and_restarts() -> Result<(), Error> {
        let problem = Problem {
            pendulum: Parameters::equal_rods(1.0, 1.0, 9.81),
            start: Motion::at_rest(0.05, 0.05),
            tolerance: 0.04,
            duration: 60.0,
            rate: 60,
        };
        let costs = Costs::CORTEX_M3;
        let pendulum = Pendulum::new(&problem.pendulum)?;
        let start = pendulum.to_state(&problem.start);
        let admissible = pendulum.admissible_step(&start)?;
        let stepping = Shadows::stepping(Method::Rk4Fixed32, problem.rate, admissible);
        let scales = scales(&pendulum, &start);
        let mut shadows = Shadows::new(stepping, &problem, scales, admissible, FINE_STEPS);
        while !shadows.are_prepared() {
            shadows.prepare(&problem, &start)?;
        }

        // Add the costs of all frames up to the tenth restart.
        let mut cost = 0.0;
        let mut frames = 0;
        let mut restarts = 0;
        while restarts < 10 {
            for run in shadows.runs() {
                run.motion
                    .as_mut()
                    .expect("prepared")
                    .advance(run.stepping.steps);
                cost += costs.of_frame(run.stepping);
            }
            shadows.compare([25.0; 2]);
            frames += 1;
            if shadows.is_due() {
                let central = shadows.runs[0].motion.as_ref().expect("prepared");
                let state = central.state();
                shadows.restart(&state);
                cost += costs.preparation;
                restarts += 1;
            }
        }
        let estimated = Shadows::cost_of_frame(stepping, admissible, problem.rate, &costs);
        let measured = cost / frames as f32;
        assert!(
            (estimated / measured - 1.0).abs() < 0.01,
            "{estimated} {measured}"
        );
        Ok(())
    }

    /// The shadows show the rounding error that random errors of the start and of all frames cause.
    /// Before the first frame, they represent the errors of the start.
    #[test]
    fn shadows_show_the_expected_error_of_roundings_in_all_frames() -> Result<(), Error> {
        for case in &CASES {
            for method in [Method::Rk4Fixed32, Method::Rk4F32Direction] {
                let [least, most] = ratios(case, method)?;
                let [lowest, highest] = case.ratios;
                assert!(
                    lowest < least && most < highest,
                    "m2 = {}, l2 = {}, {method:?}: {least} to {most}",
                    case.m2,
                    case.l2
                );
            }
        }
        Ok(())
    }

    /// At the start the error of shadows is in proportion to the rods. At 1 frame per second the
    /// error in rods of 1 cm grows by more than shadows can show. Then it is unknown, instead of
    /// too small. The errors of frames are independent, so that the recent error of 9 frames is 3
    /// times that of one.
    #[test]
    fn error_is_known_until_shadows_are_too_far_apart() -> Result<(), Error> {
        let problem = Problem {
            pendulum: Parameters::equal_rods(1.0, 0.01, 9.81),
            start: Motion::at_rest(2.5, 2.5),
            tolerance: 1e-3,
            duration: 1.0,
            rate: 1,
        };
        let pendulum = Pendulum::new(&problem.pendulum)?;
        let start = pendulum.to_state(&problem.start);
        let admissible = pendulum.admissible_step(&start)?;
        let stepping = Shadows::stepping(Method::Rk4Fixed32, 1, admissible);
        let scales = scales(&pendulum, &start);
        let mut shadows = Shadows::new(stepping, &problem, scales, admissible, FINE_STEPS);
        while !shadows.are_prepared() {
            shadows.prepare(&problem, &start)?;
        }
        // At the start the error is known and in proportion to the rods.
        let [error, doubled] = [1.0, 2.0].map(|scale| {
            let mut at_start = shadows;
            at_start.compare([scale, 3.0 * scale])
        });
        assert!(error > 0.0 && (doubled / (2.0 * error) - 1.0).abs() < 1e-6);

        for run in shadows.runs() {
            let steps = run.stepping.steps;
            run.motion.as_mut().expect("prepared").advance(steps);
        }
        assert!(shadows.compare([1.0; 2]).is_nan());

        shadows.frames = 9;
        assert_eq!(shadows.recent_error(), 3.0 * shadows.frame_error);
        Ok(())
    }

    /// Fixed point refuses the first steps per frame as too long. For rods of 150 m one step
    /// becomes two. For rods of 1 um 256 steps become more, until they are accepted. For rods of 1
    /// pm not even 65,536 steps ([`MOST_STEPS`]) are enough, and [`Shadows::prepare`] returns that
    /// error.
    #[test]
    fn refused_steps_of_shadows_become_finer_up_to_65_536() -> Result<(), Error> {
        for (length, first, accepted) in [
            (150.0, 1, Some(2)),
            (1e-6, 256, Some(32_768)),
            (1e-12, 256, None),
        ] {
            let problem = Problem {
                pendulum: Parameters::equal_rods(1.0, length, 9.81),
                start: Motion::at_rest(0.1, 0.1),
                tolerance: 1e-3,
                duration: 1.0,
                rate: 1,
            };
            let pendulum = Pendulum::new(&problem.pendulum)?;
            let start = pendulum.to_state(&problem.start);
            let stepping = Stepping {
                method: Method::Rk4Fixed32,
                steps: first,
            };
            let scales = scales(&pendulum, &start);
            let mut shadows = Shadows::new(stepping, &problem, scales, 1.0, FINE_STEPS);
            let refused = loop {
                if shadows.are_prepared() {
                    break None;
                }
                if let Err(error) = shadows.prepare(&problem, &start) {
                    break Some(error);
                }
            };
            let most = shadows.runs().map(|run| run.stepping.steps).max();
            assert_eq!(most, accepted.or(Some(MOST_STEPS)), "{length}");
            let is_too_long = matches!(
                refused,
                Some(Error::TooLarge {
                    parameter: Parameter::Dt,
                    ..
                })
            );
            assert_eq!(is_too_long, accepted.is_none(), "{length}: {refused:?}");
        }
        Ok(())
    }

    /// A shadow that the method refuses beside the start is prepared on the opposite side of the
    /// start. Here the step is just short enough for the energy of the start, so that all shadows
    /// with more energy are refused.
    #[test]
    fn refused_shadow_is_prepared_on_the_opposite_side() -> Result<(), Error> {
        // An increase of any number of the state increases the energy. The longest step that is
        // accepted is in inverse proportion to the speed.
        let at_speed = |speed: f64| Problem {
            pendulum: Parameters::equal_rods(1.0, 1.0, 9.81 * speed * speed),
            start: Motion {
                a1: 0.5,
                a2: 0.5,
                w1: 5.0 * speed,
                w2: 5.0 * speed,
            },
            tolerance: 1e-3,
            duration: 1.0,
            rate: 1,
        };
        let stepping = Stepping {
            method: Method::Rk4Fixed32,
            steps: 64,
        };

        // Choose the speed from the longest step that is accepted at a speed of 1.
        let Problem {
            pendulum, start, ..
        } = at_speed(1.0);
        let start = Pendulum::new(&pendulum)?.to_state(&start);
        let refused = DrawnMotion32::new(stepping.method, &pendulum, &start, 1.0);
        let Err(Error::TooLarge { limit, .. }) = refused else {
            panic!("a step of 1 s is not refused: {refused:?}");
        };
        let problem = at_speed(64.0 * limit * (1.0 - 1e-9));

        // Prepare all shadows.
        let pendulum = Pendulum::new(&problem.pendulum)?;
        let start = pendulum.to_state(&problem.start);
        let scales = scales(&pendulum, &start);
        let mut shadows = Shadows::new(stepping, &problem, scales, 1.0, FINE_STEPS);
        while !shadows.are_prepared() {
            assert_eq!(shadows.prepare(&problem, &start), Ok(()));
        }

        // The steps are unchanged, and all others have less energy than the central shadow.
        let [center, others @ ..] = shadows.runs.map(|run| {
            assert_eq!(run.stepping, stepping);
            let state = run.motion.expect("prepared").state();
            pendulum.energy_above_rest(&state)
        });
        assert!(
            others.iter().all(|energy| *energy < center),
            "{center} {others:?}"
        );
        Ok(())
    }

    /// If nothing can move, the units of the momenta are 1.
    #[test]
    fn units_of_momenta_are_never_zero() -> Result<(), Error> {
        let pendulum = Pendulum::new(&Parameters::equal_rods(1.0, 1.0, 0.0))?;
        assert_eq!(scales(&pendulum, &State::at_rest(1.0, 2.0)), [1.0; 2]);
        Ok(())
    }

    /// The difference of angles is given by its sine, or by 1 or -1 beyond a right angle. That of
    /// momenta is in units of the scales.
    #[test]
    fn differences_of_places_are_in_the_order_of_the_state() {
        let place = |[a1, a2]: [f64; 2], momenta| Place {
            directions: [a1, a2].map(|a| [libm::sin(a), libm::cos(a)]),
            momenta,
        };
        for (from, to, expected) in [
            ([1.0, -2.0], [1.1, -2.2], [libm::sin(0.1), libm::sin(-0.2)]),
            ([1.0, -2.0], [3.0, -5.0], [1.0, -1.0]),
            // Rod 1 passes the horizontal, and rod 2 the vertical.
            (
                [1.571, -0.001],
                [1.5, 0.1],
                [libm::sin(-0.071), libm::sin(0.101)],
            ),
        ] {
            let from = place(from, [3.0, 4.0]);
            let difference = place(to, [3.5, 3.0]).minus(&from, [2.0, 4.0]);
            let [a1, a2] = expected;
            for (value, expected) in difference.into_iter().zip([a1, a2, 0.25, -0.25]) {
                assert!((value - expected).abs() < 1e-15, "{difference:?}");
            }
        }
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
