//! The uncertainty of the reference: an ellipsoid that the flow of the motion propagates.
//!
//! The error of the reference is a vector e = (a1, a2, p1/s1, p2/s2), with the momenta in units of
//! the largest ones that the energy allows ([`scales`]). From one restart to the next, the motion
//! maps a small error e to J e, and the steps add new errors. The matrix P is an ellipsoid that
//! contains e:
//!
//! ```text
//! P  <-  (1 + 1/b) J P J^T + (1 + b) T^2 + n q^2        b = sqrt(tr(J P J^T)/tr(T^2))
//! ```
//!
//! - q is the diagonal matrix of the rounding errors of a step, n the number of steps. They are
//!   independent, so that their squares add up.
//! - T is that of the truncation errors. They may all point in the same direction, so that the
//!   errors themselves add up. With this b, the ellipsoid is the smallest one around the sum of two
//!   ellipsoids.
//!
//! J is not computed. Five cheap motions in 32 bits, the *shadows*, run beside the reference: a
//! central one and four neighbours. With the 4 x 4 matrix D of the differences of the neighbours,
//! its columns, and a unit u, P is u^2 D D^T. The motion itself turns D into J D. A restart starts
//! the central shadow at the reference, and the neighbours beside it at the columns of the Cholesky
//! factor of the new P, scaled to small distances.
//!
//! The error of a frame is u times the root of the sum of the squares of the four displacements on
//! the display, plus the errors since the last restart, which the shadows do not contain yet. Those
//! grow like the distance of the farthest neighbour, until they exceed the others: then a restart
//! adds them to P. The error is unknown if a shadow is so far that errors no longer grow in
//! proportion.

use super::candidate::{distance, greater};
use super::entry::Course;
use super::reference::Compared;
use super::run::Run;
use super::{Costs, Problem, Stepping};
use crate::bounds::Bounds;
use crate::error::Error;
use crate::methods::Advance;
use crate::methods::any::{Motion32, Motion64};
use crate::pendulum::{Direction, Pendulum, State};

/// The number of shadows: the central one, and one for each dimension of phase space.
pub(super) const SHADOWS: usize = 5;

// With half or twice of FAR, ASTRAY, LARGEST, PHASE, FEWEST or DEVIATIONS, every frame of the test
// `sweep` is accurate until its claimed time, too. The horizons of the page and of the butterfly
// change by at most 1 %, that of figure 7 by 7 %.

/// The largest distance of a neighbour after a restart, rad. It is 2^11 rounding errors of `f32`,
/// and the distance at which the shadows are restarted is four times as large: the second order of
/// the growth is then below a thousandth.
const NEAR: f64 = 1.0 / (1 << 13) as f64;
const FAR: f32 = 4.0 * NEAR as f32;
/// The distance of the central shadow from the reference at which they are restarted, rad, and the
/// distance beyond which the error is unknown. The errors would be wrong by about that share.
const ASTRAY: f32 = 1.0 / (1 << 5) as f32;
const LARGEST: f32 = 1.0 / (1 << 4) as f32;
/// The time between two restarts at the latest, as the phase that the fastest rate advances in it,
/// rad: two periods.
const PHASE: f64 = 12.0;
/// The smallest number of frames between two restarts that are due by that phase. A restart costs
/// as much as eight steps in 64 bits.
const FEWEST: u32 = 8;
/// The smallest diagonal element of the Cholesky factor, as a share of the largest deviation. At the
/// distance [`NEAR`], the shadows measure no narrower ellipsoid: four standard deviations of eight
/// roundings of `f32`, 0.3 x 2^-24 each. Narrower ones had errors of twice the bound. With half or
/// twice of it, mean horizons from high starts change by at most 0.5 %.
const SMALLEST: f64 = 1.0 / (1 << 22) as f64 / NEAR;

/// The rounding error of the start: four standard deviations of four roundings of `f64`, 0.3 x 2^-53
/// each. They are those of the sines and cosines of a1 and a1 - a2, and of each momentum.
const START: f64 = 1.0 / (1_u64 << 52) as f64;
/// The number of standard deviations that a rounding error exceeds once in 16,000 times.
const DEVIATIONS: f32 = 4.0;
/// The rows of a matrix, which belong to a1, a2, p1 and p2.
type Matrix = [[f64; 4]; 4];

/// The uncertainty of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Uncertainty {
    /// The central shadow and the other four.
    runs: [Run<Motion32>; SHADOWS],
    /// The units of the momenta, kg m^2/s.
    pub scales: [f64; 2],
    /// u: the error that a distance of 1 rad stands for, rad; NaN after a refused restart.
    unit: f32,
    /// n q^2 and T since the last restart, and how much errors have grown since then. Each error is
    /// divided by the growth when it is added.
    rounding: [f32; 4],
    truncation: [f32; 4],
    growth: f32,
    /// The number of frames since the last restart.
    since: u32,
    /// The number of frames after which the shadows are restarted at the latest.
    most: u32,
    /// True if the shadows must be restarted.
    pub is_due: bool,
}

/// Returns the largest number of frames between two restarts. `admissible` is the longest step that
/// resolves the motion, s.
pub(super) fn most_between(admissible: f64, rate: u16) -> u32 {
    ((PHASE * 4.0 * admissible * f64::from(rate)) as u32).clamp(FEWEST, 1 << 16)
}

impl Uncertainty {
    /// Creates the uncertainty of a reference at its start.
    pub fn new(course: &Course) -> Self {
        Self {
            runs: core::array::from_fn(|_| Run::new(course.shadows)),
            scales: course.scales,
            unit: (START / NEAR) as f32,
            rounding: [0.0; 4],
            truncation: [0.0; 4],
            growth: 1.0,
            since: 0,
            most: course.most,
            is_due: false,
        }
    }

    /// Returns the method and step count of the shadows.
    pub fn stepping(&self) -> Stepping {
        let [center, ..] = &self.runs;
        center.stepping
    }

    /// Prepares one shadow. Returns false if all are prepared.
    pub fn prepare(&mut self, problem: &Problem, start: &State<f64>) -> Result<bool, Error> {
        let scales = self.scales;
        let mut runs = self.runs.iter_mut().enumerate();
        let Some((number, run)) = runs.find(|(_, run)| run.motion.is_none()) else {
            return Ok(false);
        };

        // The momenta of a start at rest are exact. Those of others are sums, which may be smaller
        // than their terms. A neighbour on the other side may be in range if this one is not.
        let moves = start.p1 != 0.0 || start.p2 != 0.0;
        let of_momenta = if moves { 1.0 } else { 0.0 };
        let shares = [1.0, 1.0, of_momenta, of_momenta];
        let mut prepared = |sign: f64| {
            let difference = core::array::from_fn(|i| {
                let is_own = number == i + 1;
                if is_own { sign * NEAR * shares[i] } else { 0.0 }
            });
            run.prepare(problem, &beside(start, difference, scales))
        };
        prepared(1.0).or_else(|_| prepared(-1.0))?;
        Ok(true)
    }

    /// Makes steps of all shadows towards the next frame, as [`Run::advance`] does for one.
    pub fn advance(&mut self, costs: &Costs, cost: f32, spent: f32) -> f32 {
        let price = costs.of_step(self.stepping());
        let mut own = 0.0;
        for run in &mut self.runs {
            own += run.advance(price, cost, spent + own);
        }
        own
    }

    /// Returns true if all shadows have arrived at the next frame.
    pub fn is_there(&self) -> bool {
        self.runs.iter().all(Run::is_there)
    }

    /// Adds the errors since the last restart to P, and starts all shadows beside the reference.
    #[inline(never)] // Counted by its name.
    pub fn restart(&mut self, reference: &Motion64) {
        let scales = self.scales;
        let places = self.runs.each_ref().map(Place::of);
        let [own, others @ ..] = &places;
        let mut rows = [[0.0; 4]; 4];
        for (column, other) in others.iter().enumerate() {
            for (row, number) in rows.iter_mut().zip(other.minus(own, scales)) {
                row[column] = number;
            }
        }

        // P in units of u^2.
        let unit = f64::from(self.unit);
        let growth = f64::from(self.growth) / unit;
        let truncation = self.truncation.map(|error| growth * f64::from(error));
        let rounding = self
            .rounding
            .map(|square| growth * growth * f64::from(square));

        // Steps without a truncation error have b = infinity.
        let [of_rows, of_truncation] = [
            rows.iter().map(|row| dot(row, row)).sum::<f64>(),
            dot(&truncation, &truncation),
        ]
        .map(libm::sqrt);
        let both = of_rows + of_truncation;
        let grown = libm::sqrt(both / of_rows);
        let rows = rows.map(|row| row.map(|number| grown * number));
        let added = core::array::from_fn(|i| {
            let share = truncation[i] / f64::max(of_truncation, f64::MIN_POSITIVE);
            both * share * truncation[i] + rounding[i]
        });
        let squares = core::array::from_fn(|i| dot(&rows[i], &rows[i]) + added[i]);
        let largest = <[f64; 4]>::into_iter(squares).fold(0.0, f64::max);
        let factor = cholesky(&rows, added, SMALLEST * SMALLEST * largest);

        // Scale the columns to small distances, and u such that P stays the same.
        let deviation = libm::sqrt(largest);
        let scale = NEAR / deviation;
        self.unit = (unit / scale) as f32;
        self.rounding = [0.0; 4];
        self.truncation = [0.0; 4];
        self.growth = 1.0;
        self.since = 0;
        self.is_due = false;
        let center = reference.state();
        for (number, run) in self.runs.iter_mut().enumerate() {
            if let Some(shadow) = &mut run.motion {
                let difference = match number.checked_sub(1) {
                    Some(column) => factor.map(|row| scale * row[column % 4]),
                    None => [0.0; 4],
                };
                match shadow.started(&beside(&center, difference, scales)) {
                    Ok(started) => *shadow = started,
                    Err(_) => self.unit = f32::NAN,
                }
            }
        }
    }

    /// Compares the shadows with the reference in the next frame. Returns a bound of the reference's
    /// error, in units of the tolerance; NaN if it is unknown. `rods` are the lengths of the rods in
    /// that unit.
    pub fn compare(&mut self, rods: [f32; 2], reference: &Compared) -> f32 {
        self.since += 1;
        let [center, others @ ..] = self.runs.each_mut().map(Run::frame);
        let astray = distance([1.0; 2], &center, &reference.directions);
        let mut farthest = 0.0;
        let mut squares = 0.0;
        for other in &others {
            farthest = greater(distance([1.0; 2], other, &center), farthest);
            let shown = distance(rods, other, &center);
            squares += shown * shown;
        }
        if !(farthest <= LARGEST && astray <= LARGEST) {
            return f32::NAN;
        }

        self.growth = f32::max(self.growth, farthest / NEAR as f32);
        let steps = reference.steps;
        for i in 0..4 {
            let rounding = DEVIATIONS * reference.rounding[i] / self.growth;
            self.rounding[i] += rounding * rounding * steps;
            self.truncation[i] += reference.truncation[i] / self.growth;
        }
        let recent: f32 = (0..2)
            .map(|rod| rods[rod] * (self.truncation[rod] + libm::sqrtf(self.rounding[rod])))
            .sum();

        let recent = self.growth * recent;
        let older = self.unit * libm::sqrtf(squares);
        self.is_due =
            farthest > FAR || astray > ASTRAY || recent > older || self.since >= self.most;
        older + recent
    }
}

/// Returns the units of the momenta p1 and p2, kg m^2/s: the largest momenta that the energy of
/// `start` allows, at least those of a millionth of the turnover energy; 1 if nothing can move.
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
    /// units of `scales`. The difference of an angle is its sine, or 1 or -1 beyond a right angle.
    fn minus(&self, other: &Self, [s1, s2]: [f64; 2]) -> [f64; 4] {
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
        [
            angle(rod1, other1),
            angle(rod2, other2),
            (p1 - other_p1) / s1,
            (p2 - other_p2) / s2,
        ]
    }
}

/// Returns the sum of `state` and `difference`, whose momenta are in units of `scales`.
fn beside(state: &State<f64>, difference: [f64; 4], [s1, s2]: [f64; 2]) -> State<f64> {
    let [a1, a2, p1, p2] = difference;
    State {
        a1: state.a1 + a1,
        a2: state.a2 + a2,
        p1: state.p1 + s1 * p1,
        p2: state.p2 + s2 * p2,
    }
}

/// Returns the lower triangular matrix L with L L^T = D D^T + diag(`added`), where `rows` are those
/// of D. Squares of its diagonal elements are at least `least`.
fn cholesky(rows: &Matrix, added: [f64; 4], least: f64) -> Matrix {
    let mut factor = [[0.0; 4]; 4];
    for i in 0..4 {
        for j in 0..=i {
            let rest = dot(&rows[i], &rows[j]) - dot(&factor[i], &factor[j]);
            factor[i][j] = if i == j {
                libm::sqrt(f64::max(rest + added[i], least))
            } else {
                rest / factor[j][j]
            };
        }
    }
    factor
}

/// Returns the scalar product of two rows.
fn dot(a: &[f64; 4], b: &[f64; 4]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
