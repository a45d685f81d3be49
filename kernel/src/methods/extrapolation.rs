//! W. B. Gragg's extrapolation: steps of any even order, for any system of first-order equations.
//!
//! # Method
//!
//! A step from z of length H is computed K times, in *rows* of n = 2, 4 .. 2 K substeps, by the
//! modified midpoint rule. With h = H/n:
//!
//! ```text
//! y0 = z      y1 = y0 + h f(y0)      y(i+1) = y(i-1) + 2 h f(y(i))      i = 1 .. n - 1
//! ```
//!
//! The error of y(n) is a series in the even powers of 1/n. The weighted sum of the ends y(n) of
//! all rows, with the weights
//!
//! ```text
//! w(n) = product over the other rows m of n^2/(n^2 - m^2),
//! ```
//!
//! therefore has an error of order 2 K only. A step costs K^2 + 1 evaluations of f. Source: Gragg
//! 1965, without his smoothing step; `[Hairer I]`, II.9.

use crate::error::{Error, Parameter};
use crate::numbers::Real;

/// The largest number of rows, which is that of order 16.
pub const ROWS: usize = 8;

pub(crate) const fn is_order(order: u32) -> bool {
    order % 2 == 0 && order >= 2 && order <= 2 * ROWS as u32
}

/// The phases in [`stable`], for the orders 2, 4 .. 16.
const STABLE: [f64; ROWS] = [0.95, 2.86, 2.51, 3.67, 5.28, 4.77, 6.37, 7.35];

/// Returns the largest phase w dt, rad, of a step of this order that lets an oscillation of
/// frequency w grow by less than a tenth.
///
/// The orders 2, 6, 10 and 14 are stable in no step at all, but only just: an oscillation grows by
/// less than 1e-4 in a step of up to 0.16, 0.94, 2.14 and 6.3 rad.
pub(crate) const fn stable(order: u32) -> f64 {
    if is_order(order) {
        STABLE[order as usize / 2 - 1]
    } else {
        f64::INFINITY
    }
}

/// Extrapolation of an order 2, 4 .. 16, for any system of equations in the numbers `R`. The unit
/// tests check the stability of all orders.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrapolation<R> {
    rows: usize,
    /// 2/n for each row of n substeps.
    shares: [R; ROWS],
    weights: [R; ROWS],
}

/// Returns the number of rows. Refuses an order that is not 2, 4 .. 16, by [`Error::OutOfRange`].
pub(super) fn rows(order: u32) -> Result<usize, Error> {
    if is_order(order) {
        Ok(order as usize / 2)
    } else {
        Err(Error::OutOfRange {
            parameter: Parameter::Order,
            value: f64::from(order),
        })
    }
}

/// Returns n/2 of a row, which is counted from 0.
pub(super) fn half_substeps(row: usize) -> f64 {
    (row + 1) as f64
}

pub(super) fn weight(row: usize, rows: usize) -> f64 {
    let square = half_substeps(row) * half_substeps(row);
    let mut weight = 1.0;
    for other in (0..rows).filter(|&other| other != row) {
        weight *= square / (square - half_substeps(other) * half_substeps(other));
    }
    weight
}

impl<R: Real> Extrapolation<R> {
    /// Prepares steps of `order` 2, 4 .. 16. Refuses any other order, by [`Error::OutOfRange`].
    pub fn new(order: u32) -> Result<Self, Error> {
        let rows = rows(order)?;
        let mut weights = [R::ZERO; ROWS];
        for (row, place) in weights.iter_mut().enumerate().take(rows) {
            *place = R::from_f64(weight(row, rows));
        }
        Ok(Self {
            rows,
            shares: core::array::from_fn(|row| R::from_f64(1.0 / half_substeps(row))),
            weights,
        })
    }

    /// Computes one step for z' = f(z): returns the state a time `dt` after `z`.
    ///
    /// The unit of time is that of f. A negative `dt` steps backwards. A step that is too long for
    /// f gives a meaningless state; [`Pendulum::run`](crate::Pendulum::run) lists the limits for an
    /// oscillation. NaN or infinity in `z` or `dt` gives NaN or infinity.
    ///
    /// ```
    /// use double_pendulum::Extrapolation;
    ///
    /// let method = Extrapolation::new(12)?;
    /// let [x, y] = method.step(|&[x, y]| [y, -x], &[0.0_f64, 1.0], 0.5);
    /// let error = (x - 0.5_f64.sin()).abs().max((y - 0.5_f64.cos()).abs());
    /// assert!(error < 3e-14); // The error of the method is 2e-14.
    /// # Ok::<(), double_pendulum::Error>(())
    /// ```
    pub fn step<const N: usize>(&self, f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
        // All sums are sums of changes, which round less than sums of states.
        let slope = |change: &[R; N], row: usize| {
            let at = core::array::from_fn(|i| z[i] + change[i]);
            let span = self.shares[row % ROWS] * dt;
            f(&at).map(|rate| span * rate)
        };
        let first = slope(&[R::ZERO; N], 0);

        let mut sum = [R::ZERO; N];
        let mut reference = sum;
        for row in (0..self.rows).rev() {
            let share = self.shares[row % ROWS];
            let mut before = [R::ZERO; N];
            let mut last = first.map(|first| R::HALF * (first * share));
            for _ in 0..2 * row + 1 {
                let slope = slope(&last, row);
                let next = core::array::from_fn(|i| before[i] + slope[i]);
                before = last;
                last = next;
            }

            // All weights sum to 1, so that the small differences from the first end can be
            // weighted instead of the ends themselves.
            if row + 1 == self.rows {
                sum = last;
                reference = last;
            } else {
                let weight = self.weights[row % ROWS];
                sum = core::array::from_fn(|i| sum[i] + (last[i] - reference[i]) * weight);
            }
        }
        core::array::from_fn(|i| z[i] + sum[i])
    }

    /// Returns the shares and the weights of all rows, n = 2 first, and the number of rows.
    pub(super) fn parts(&self) -> (&[R; ROWS], &[R; ROWS], usize) {
        (&self.shares, &self.weights, self.rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the growth of an oscillation in a step of `phase` rad.
    fn growth(method: &Extrapolation<f64>, phase: f64) -> f64 {
        let [x, y] = method.step(|&[x, y]| [y, -x], &[1.0, 0.0], phase);
        libm::hypot(x, y)
    }

    #[test]
    fn steps_are_stable_up_to_the_phase_in_the_table() -> Result<(), Error> {
        for order in (2..=16).step_by(2) {
            let method = Extrapolation::new(order)?;
            let most = stable(order);
            for share in 1..=1000 {
                let phase = most * f64::from(share) / 1000.0;
                let growth = growth(&method, phase);
                assert!(growth < 1.1, "order {order}, {phase} rad: {growth}");
            }
            assert!(
                growth(&method, most + 0.02) > 1.1,
                "order {order}: no further"
            );
        }

        for (order, phase) in [(2, 0.16), (6, 0.94), (10, 2.14), (14, 6.3)] {
            let method = Extrapolation::new(order)?;
            let most = (1..=100)
                .map(|share| growth(&method, phase * f64::from(share) / 100.0))
                .fold(0.0, f64::max);
            assert!(most > 1.0 && most < 1.000_1, "order {order}: {most}");
        }
        Ok(())
    }

    /// The error would be 10 epsilons if the weights multiplied the changes of all rows instead of
    /// their differences.
    #[test]
    fn change_by_a_constant_rate_is_hardly_rounded() -> Result<(), Error> {
        for order in (2..=10).step_by(2) {
            let method = Extrapolation::new(order)?;
            for share in 1..=100 {
                let dt = f64::from(share) / 100.0;
                let [change] = method.step(|_| [1.0], &[0.0], dt);
                let error = (change / dt - 1.0).abs() / f64::EPSILON;
                assert!(error <= 5.0, "order {order}, step {dt}: {error}");
            }
        }
        Ok(())
    }
}
