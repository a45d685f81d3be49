//! The six quantities of a motion in floating point, as sums that may carry their rounding errors.

use super::{Coefficients, Scale, directions, missing, quantities};
use crate::error::{Error, Parameter, check_finite};
use crate::numbers::Real;
use crate::pendulum::State;

/// Returns the six quantities of a motion at its start, and the part that rounding to `R` loses.
pub(crate) fn start<R: Real>(
    coefficients: &Coefficients<R>,
    scale: &Scale,
    start: &State<f64>,
) -> Result<[[R; 6]; 2], Error> {
    start.check()?;
    let norm = coefficients.norm.to_f64();
    let exact = quantities(start, norm, [scale.momentum; 2]);
    scale.check::<R>([exact[4], exact[5]])?;
    let lost = exact.map(|z| R::from_f64(z - R::from_f64(z).to_f64()));
    Ok([exact.map(R::from_f64), lost])
}

/// The six quantities of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sums<R, const COMPENSATED: bool> {
    pub z: [R; 6],
    /// The rounding errors of the last addition to `z`, carried into the next; zero if not
    /// `COMPENSATED`.
    pub lost: [R; 6],
}

impl<R: Real, const COMPENSATED: bool> Sums<R, COMPENSATED> {
    pub const ZERO: Self = Self {
        z: [R::ZERO; 6],
        lost: [R::ZERO; 6],
    };

    pub fn at(
        coefficients: &Coefficients<R>,
        scale: &Scale,
        state: &State<f64>,
    ) -> Result<Self, Error> {
        let [z, lost] = start(coefficients, scale, state)?;
        Ok(Self {
            z,
            lost: if COMPENSATED { lost } else { [R::ZERO; 6] },
        })
    }

    pub fn check(&self, coefficients: &Coefficients<R>, momenta: [R; 2]) -> Result<(), Error> {
        let [sin1, cos1, s, c, ..] = self.z;
        let [_, [sin2, cos2]] = directions(&self.z, coefficients.norm);
        let [p1, p2] = momenta;

        let numbers = [
            (Parameter::A1, sin1),
            (Parameter::A1, cos1),
            (Parameter::A2, s),
            (Parameter::A2, c),
            (Parameter::A2, sin2),
            (Parameter::A2, cos2),
            (Parameter::P1, p1),
            (Parameter::P2, p2),
        ];
        check_finite(numbers).map_err(Error::diverged)
    }

    pub fn sides(&self) -> [[i32; 2]; 2] {
        let [sin1, cos1, s, c, ..] = self.z;
        let sin2 = sin1 * c - cos1 * s;
        let cos2 = cos1 * c + sin1 * s;
        [[sin1.side(), cos1.side()], [sin2.side(), cos2.side()]]
    }

    pub fn add(&mut self, i: usize, increment: R) {
        if COMPENSATED {
            let wanted = increment + self.lost[i];
            let sum = self.z[i] + wanted;
            self.lost[i] = wanted - (sum - self.z[i]);
            self.z[i] = sum;
        } else {
            self.z[i] = self.z[i] + increment;
        }
    }

    /// Restores the lengths to first order in the error.
    pub fn restore_lengths(&mut self, coefficients: &Coefficients<R>) {
        let pairs = [
            (0, R::ONE, R::HALF),
            (2, coefficients.norm, coefficients.half_inverse_square),
        ];
        for (i, length, gain) in pairs {
            let [s, c] = [self.z[i], self.z[i + 1]];
            let lost = s * self.lost[i] + c * self.lost[i + 1];
            let missing = missing([s, c], length, gain, lost);
            self.add(i, s * missing);
            self.add(i + 1, c * missing);
        }
    }
}
