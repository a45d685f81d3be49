//! The errors of a step in 64-bit fixed point: the truncation, which the step itself measures, and
//! the rounding, which follows from the formats of the numbers.
//!
//! # Truncation
//!
//! A step extrapolates the ends T(k) of its rows of 2 k substeps, k = 1 .. 5, with weights w(k). The
//! errors of T(k) are a series in k^-2, and the weights cancel its first four terms. The sums
//!
//! ```text
//! d8 = sum w(k) T(k) k^-2        d6 = sum w(k) T(k) k^-4
//! ```
//!
//! contain no T(k) without an error, because the weights also cancel k^2 and k^4 against it. They
//! are the errors of the same step with its first row left out (order 8), and about that with two
//! rows left out (order 6). The differences from the last row replace T(k): they change neither sum.
//!
//! If the rows k = n .. 5 are extrapolated, the first term of the error is proportional to
//! h^(12 - 2 n)/(n ... 5)^2 (`[Hairer I]`, section II.9). So the quotient of the errors of two
//! orders is 4 times as large for n = 1 and 2 as for n = 2 and 3, and the step itself has an error
//! of about 4 d8 |d8|/|d6|. The bound of a step is
//!
//! ```text
//! T = d8 max(1, x)        x = 32 |d8|/|d6|
//! ```
//!
//! A step with x up to 1 resolves the motion. In other steps the first terms tell little of the next
//! one, so that x contains another factor of 8. That is a choice: with half of it and with twice
//! the factor, every frame of the test `sweep` is accurate until its claimed time, too. A step whose
//! d8 is no larger than its own rounding error counts as exact.
//!
//! # Rounding
//!
//! A product of two numbers is off by 0.3 units of 2^-64 (standard deviation), and 2^n times that
//! after a shift by n bits to the left. The slopes have these errors, with the shifts of
//! [`Equations`](super::rows::Equations) and of the pendulum ([`Shifts`]). Row k adds k of them to
//! its end, and the step adds the rows with their weights. So an error e of a slope becomes
//! e sqrt(sum w^2 k) in the step. An error e of a rate is first multiplied by the 1/k of the step
//! that the slope spans, and becomes e H sqrt(sum w^2 / k), where H is the step in units of time.

use super::rows::{EIGHTH, Rows};
use crate::methods::extrapolation::{half_substeps, weight};
use crate::methods::scaling::Shifts;
use crate::numbers::fixed::{Q64, scaled};

/// The number of rows of a step that measures its truncation: order 10.
const MEASURED_ROWS: usize = 5;
/// The common denominators of k^-2 and of k^-4 for k = 1 .. 4. The second one is a multiple of 2^8.
const SQUARES: i32 = 144;
const FOURTHS: i32 = SQUARES * SQUARES;

/// The sums d8 times 144, and d6 times 81, of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moments {
    eighth: [Q64; 6],
    sixth: [Q64; 6],
}

impl Moments {
    pub const ZERO: Self = Self {
        eighth: [Q64(0); 6],
        sixth: [Q64(0); 6],
    };

    /// Adds the weighted differences of the row `row`, counted from 0, from the last row.
    #[inline(never)] // Inlined, every row would have a copy.
    pub fn add(&mut self, row: usize, differences: &[Q64; 6]) {
        // The compiler cannot see that the square is not 0.
        let square = ((row as i32 + 1) * (row as i32 + 1)).max(1);
        for (i, &difference) in differences.iter().enumerate() {
            // Sums wrap, but return into range: d8 is far below 1/144, and d6 below 1/81.
            self.eighth[i] = self.eighth[i] + difference.times(SQUARES / square);
            let part = Q64(difference.0 >> 8).times(FOURTHS / (square * square).max(1));
            self.sixth[i] = self.sixth[i] + part;
        }
    }
}

/// The bounds T of steps, added.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Truncation {
    /// The largest rounding errors of d8, times 144.
    noise: [u64; 6],
    /// T, times 144.
    bounds: [u64; 6],
}

/// Four standard deviations of the rounding error of d8, in those of a step: its weights w/k^2 add
/// 0.06 of the roundings that w adds.
const NOISE: f64 = 0.24;

impl Truncation {
    /// Creates the errors of no steps. `rounding` is that of [`Rows::rounding`], and `norm` nu/sigma.
    pub(super) fn new([a1, a2, p1, p2]: [f64; 4], norm: f64) -> Self {
        let of_rod1 = EIGHTH * a1;
        let of_elbow = EIGHTH * norm * a2;
        let errors = [of_rod1, of_rod1, of_elbow, of_elbow, p1, p2];
        Self {
            noise: errors.map(|error| (NOISE * f64::from(SQUARES) * error) as u64),
            ..Self::default()
        }
    }

    /// Adds the bound of a step.
    pub(super) fn add(&mut self, moments: &Moments) {
        let magnitudes = |sums: &[Q64; 6]| sums.map(|sum| sum.0.unsigned_abs());
        let eighth = magnitudes(&moments.eighth);
        if eighth
            .iter()
            .zip(&self.noise)
            .all(|(d8, noise)| d8 <= noise)
        {
            return;
        }

        // x = 32 (e/144)/(s/81) = 18 e/s, rounded up.
        let size = |sums: [u64; 6]| {
            sums.iter()
                .fold(0, |sum: u64, one| sum.saturating_add(*one))
        };
        let numerator = size(eighth).saturating_mul(18);
        let sixth = size(magnitudes(&moments.sixth));
        let x = if numerator <= sixth {
            1
        } else {
            numerator.div_ceil(sixth.max(1))
        };
        for (sum, d8) in self.bounds.iter_mut().zip(eighth) {
            *sum = sum.saturating_add(d8.saturating_mul(x));
        }
    }

    /// Returns the bounds, and begins anew.
    pub fn take(&mut self) -> Self {
        let new = Self {
            noise: self.noise,
            ..Self::default()
        };
        core::mem::replace(self, new)
    }

    /// Returns the bounds of sin a1, cos a1, S and C, as they are stored, and of P1 and P2, in units
    /// of 2^-64.
    pub(super) fn in_units(&self) -> [f32; 6] {
        self.bounds.map(|sum| sum as f32 / SQUARES as f32)
    }
}

/// The standard deviation of the error of a product, in units of 2^-64.
const PRODUCT: f64 = 0.3;
/// That of the rate u = (P1 - C P2) r by the error of r, which is up to 2^-55 of it: a quarter of
/// that, 2^-57, times the largest u, 1/8.
const INVERSE: f64 = 16.0;

impl Rows {
    /// Returns the standard deviation of the rounding error of a step of order 10: of a1 and a2, and
    /// of P1 and P2, in units of 2^-64.
    pub fn rounding(&self) -> [f64; 4] {
        let Shifts {
            momentum,
            inverse,
            upper,
            lower,
        } = self.shifts();
        let up = |by: u32| scaled(PRODUCT, by as i32);
        let over = |by: u32| scaled(1.0, -(by as i32));

        // The errors of rates: u is shifted by 2 bits and by those of r, C P2 and C u by 3 bits.
        let u = hypot(&[
            INVERSE,
            up(inverse + 2),
            up(3) * over(momentum) / over(inverse),
        ]);
        let v = hypot(&[u, up(3)]);
        let [u1, v2] = [u * over(upper), v * over(lower)];
        // The errors of slopes. A rate over the share of the step is shifted by 3 bits, but is only
        // half of the angle, as it is stored. A direction is an eighth, and is shifted by 2 bits.
        let turned = up(2);
        let turned1 = hypot(&[turned, turned * over(upper)]);
        let turned_elbow = hypot(&[
            turned / self.norm_value(),
            turned * over(upper),
            turned * over(lower),
        ]);
        // u v is shifted by 4 bits and multiplied by 2 S, at most 1/4; u itself has an error, too.
        let force = hypot(&[up(2), up(2), up(1)]);
        let force1 = hypot(&[up(0), force * over(upper + momentum)]);
        let force2 = hypot(&[up(1), force * over(lower)]);

        let rows = |power: i32| {
            let square = |row: usize| {
                let w = weight(row, MEASURED_ROWS);
                let k = half_substeps(row);
                w * w * if power > 0 { k } else { 1.0 / k }
            };
            libm::sqrt((0..MEASURED_ROWS).map(square).sum())
        };
        let of_slope = rows(1);
        let of_rate = rows(-1) * self.step();
        let a1 = hypot(&[8.0 * of_slope * turned1, of_rate * u1]);
        let elbow = hypot(&[8.0 * of_slope * turned_elbow, of_rate * u1, of_rate * v2]);
        let pull = of_rate * hypot(&[u, v]) / 8.0;
        [
            a1,
            hypot(&[a1, elbow]),
            hypot(&[of_slope * force1, pull * over(upper + momentum)]),
            hypot(&[of_slope * force2, pull * over(lower)]),
        ]
    }
}

/// Returns the root of the sum of the squares.
fn hypot(parts: &[f64]) -> f64 {
    libm::sqrt(parts.iter().map(|part| part * part).sum())
}
