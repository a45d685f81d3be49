//! Steps of any even order, for any system of first-order equations, from one number and no table.

use crate::error::{Error, Parameter};
use crate::real::Real;
use crate::ring::Ring;

/// The most rows a step may have: order 16. Tables of rows are read at `row % ROWS`, which tells the compiler that it is there.
pub const ROWS: usize = 8;

/// W. B. Gragg's extrapolation of order 2 K (1965; `[Hairer I]`, II.9, his smoothing step left out).
///
/// Row n = 2, 4 .. 2 K goes through the step with n modified midpoints. Where it ends is off by a series in the even powers
/// of 1/n, so that the sum of all ends with the weights w_n, the product over the other rows m of n^2/(n^2 - m^2), is off
/// by order 2 K only. K^2 + 1 evaluations, two sums to each; 4 N numbers of stack.
///
/// The orders 6, 8, 12 and 16 are measured by the repository's tests.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Extrapolation<R> {
    rows: usize,
    /// 1/(n/2), the share of the step between every second midpoint.
    shares: [R; ROWS],
    /// w_n/2^doublings, at most 1: w_n reaches 51, more than every kind of number holds.
    weights: [R; ROWS],
    doublings: u32,
}

/// n/2 of a row.
fn half(row: usize) -> f64 {
    (row + 1) as f64
}

/// w_n of one of `rows` rows.
#[inline(never)]
fn weight(row: usize, rows: usize) -> f64 {
    let square = half(row) * half(row);
    let others = (0..rows).filter(|&other| other != row).map(half);
    others.map(|m| square / (square - m * m)).product()
}

impl<R: Ring> Extrapolation<R> {
    /// Prepares steps of `order` 2, 4 .. 16; refuses any other.
    #[inline(never)]
    pub fn new(order: u32) -> Result<Self, Error> {
        let rows = order as usize / 2;
        if order % 2 == 1 || !(1..=ROWS).contains(&rows) {
            return Err(Error::OutOfRange { parameter: Parameter::Order, value: f64::from(order) });
        }
        let largest = (0..rows).map(|row| libm::fabs(weight(row, rows))).fold(1.0, libm::fmax);
        let doublings = libm::ceil(libm::log2(largest)) as u32;
        let mut method = Self { rows, doublings, shares: [R::constant(0.0); ROWS], weights: [R::constant(0.0); ROWS] };
        for (row, (share, scaled)) in method.shares.iter_mut().zip(&mut method.weights).enumerate() {
            *share = R::constant(1.0 / half(row));
            if row < rows {
                *scaled = R::constant(libm::scalbn(weight(row, rows), -(doublings as i32)));
            }
        }
        Ok(method)
    }

    /// The order, 2 K.
    pub fn order(&self) -> u32 {
        2 * self.rows as u32
    }

    /// What a step adds to `z`, for those who let the step enter with the constants of their equations:
    /// `slope(z, row)` is to be H/(row + 1) f(z), H being the step.
    #[inline(always)]
    pub(crate) fn increment_by<const N: usize>(&self, slope: impl Fn(&[R; N], usize) -> [R; N], z: &[R; N]) -> [R; N] {
        let first = slope(z, 0);
        let row_end = |row: usize| {
            let further = |d: &[R; N]| -> [R; N] { slope(&core::array::from_fn(|i| z[i] + d[i]), row) };
            // half the share of the first slope, then from one midpoint to the next but one
            let mut odd = first.map(|slope| (slope * self.shares[row % ROWS]).half());
            let mut even = further(&odd);
            for _ in 0..row {
                let slope = further(&even);
                odd = core::array::from_fn(|i| odd[i] + slope[i]);
                let slope = further(&odd);
                even = core::array::from_fn(|i| even[i] + slope[i]);
            }
            even
        };
        // All weights sum to 1: small differences are weighted instead of the ends themselves.
        let last = row_end(self.rows - 1);
        let mut sum = last;
        for row in 0..self.rows - 1 {
            let end = row_end(row);
            for i in 0..N {
                let share = (end[i] - last[i]) * self.weights[row % ROWS];
                sum[i] = sum[i] + (0..self.doublings).fold(share, |share, _| share.twice());
            }
        }
        sum
    }
}

impl<R: Real> Extrapolation<R> {
    /// One step for z' = f(z): the state a time `dt` after `z`; a negative `dt` steps backwards.
    ///
    /// ```
    /// use double_pendulum::extrapolation::Extrapolation;
    ///
    /// let method = Extrapolation::new(12)?;
    /// let [x, y] = method.step(|&[x, y]| [y, -x], &[0.0_f64, 1.0], 0.5);
    /// assert!((x - 0.5_f64.sin()).abs().max((y - 0.5_f64.cos()).abs()) < 3e-14); // 2e-14 is the method's own
    /// # Ok::<(), double_pendulum::Error>(())
    /// ```
    #[inline]
    pub fn step<const N: usize>(&self, f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
        let change = self.increment(f, z, dt);
        core::array::from_fn(|i| z[i] + change[i])
    }

    /// What [`step`](Self::step) adds to `z`, for those who carry the rounding error of that addition along.
    #[inline]
    pub fn increment<const N: usize>(&self, f: impl Fn(&[R; N]) -> [R; N], z: &[R; N], dt: R) -> [R; N] {
        self.increment_by(
            |z, row| {
                let share = dt * self.shares[row % ROWS];
                f(z).map(|slope| share * slope)
            },
            z,
        )
    }
}
