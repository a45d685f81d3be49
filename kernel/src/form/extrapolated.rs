//! The direction form by extrapolation: the exact motion to the last digits of an `f64`, cheaply.

use super::checkpoint::{Check, RestoreError};
use super::coefficients::Span;
use super::direction::{DirectionForm, DirectionState};
use super::equations::{Coefficients, Same, Units, increments_with_inverse};
use super::inverse::Divided;
use super::sum::{Compensated, Sum};
use super::{Direction, Form};
use crate::error::Error;
use crate::extrapolation::{Extrapolation, ROWS};
use crate::params::Parameters;
use crate::ring::Ring;
use crate::sealed::Sealed;
use crate::state::State;

/// As [`DirectionForm`], but each step by [`Extrapolation`] of order `ORDER`, 2, 4 .. 16, after which the lengths of the
/// directions are restored and r = 1/(m + S^2) is computed anew. Within the step r is a seventh quantity,
/// r' = -2 S S' r^2: a division at every stage would be waited for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ExtrapolatedForm<const ORDER: u32, S = Compensated<f64>> {
    direction: DirectionForm<f64, S, Divided>,
    method: PacedExtrapolation<f64>,
}

/// What an [`ExtrapolatedForm`] carries from step to step.
pub type ExtrapolatedState<S> = DirectionState<f64, S>;

/// An extrapolation and the constants of the equations for each of its rows, times the share of a step between every second
/// midpoint: so nothing but two rates is multiplied by the step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PacedExtrapolation<R> {
    method: Extrapolation<R>,
    rows: [(R, Coefficients<R>); ROWS],
}

/// The `units`, and rates times the share of the step.
#[derive(Clone, Copy)]
struct Paced<R, U> {
    units: U,
    share: R,
}

impl<R: Ring, U: Units<R>> Units<R> for Paced<R, U> {
    #[inline(always)]
    fn momentum(&self, product: R) -> R {
        self.units.momentum(product)
    }
    #[inline(always)]
    fn rate(&self, momentum: R, inverse: R) -> R {
        self.units.rate(momentum, inverse)
    }
    #[inline(always)]
    fn paced(&self, u: R) -> R {
        self.share * u
    }
    #[inline(always)]
    fn turns(&self, [u, v]: [R; 2]) -> [R; 2] {
        self.units.turns([u, self.share * v])
    }
    #[inline(always)]
    fn forces(&self, force: R::Torque) -> [R::Torque; 2] {
        self.units.forces(force)
    }
    #[inline(always)]
    fn inverse(&self, product: R) -> R {
        self.units.inverse(product)
    }
}

impl<R: Ring<Slope = R, Torque = R>> PacedExtrapolation<R> {
    /// Steps of `step` units of time; `gravity` is (G1, G2) in those units.
    pub fn new(order: u32, step: f64, coefficients: Coefficients<R>, gravity: [f64; 2]) -> Result<Self, Error> {
        let mut rows = [(R::constant(0.0), coefficients); ROWS];
        for (row, (paced, coefficients)) in rows.iter_mut().enumerate() {
            let share = step / (row + 1) as f64;
            *paced = R::constant(share);
            coefficients.gravity = gravity.map(|g| R::constant(share * g));
        }
        Ok(Self { method: Extrapolation::new(order)?, rows })
    }

    /// What a step adds to (sin a1, cos a1, S, C, P1, P2, r).
    #[inline(always)]
    pub fn increment(&self, units: &impl Units<R>, z: &[R; 7]) -> [R; 7] {
        self.method.increment_by(
            |z, row| {
                let (share, coefficients) = &self.rows[row % ROWS];
                increments_with_inverse(coefficients, &Paced { units: *units, share: *share }, z)
            },
            z,
        )
    }
}

impl<const ORDER: u32, S: Sum<f64>> ExtrapolatedForm<ORDER, S> {
    fn check(&self) -> Check {
        self.direction.check(256 + u64::from(ORDER))
    }
}

impl<const ORDER: u32, S: Sum<f64>> Sealed for ExtrapolatedForm<ORDER, S> {}

impl<const ORDER: u32, S: Sum<f64>> Form<f64> for ExtrapolatedForm<ORDER, S> {
    type Carried = ExtrapolatedState<S>;

    fn new(parameters: &Parameters<f64>, dt: f64) -> Result<Self, Error> {
        let direction = DirectionForm::with_span(parameters, dt, Span::STEP)?;
        let coefficients = direction.coefficients;
        Ok(Self { direction, method: PacedExtrapolation::new(ORDER, 1.0, coefficients, coefficients.gravity)? })
    }

    fn start(&self, state: &State<f64>) -> Result<Self::Carried, Error> {
        self.direction.start(state)
    }

    #[inline]
    fn advance(&self, carried: &mut Self::Carried, steps: u32) {
        for _ in 0..steps {
            let [sin1, cos1, s, c, p1, p2] = carried.z;
            let start = [sin1, cos1, s, c, p1, p2, carried.inverse];
            let change = self.method.increment(&Same, &start);
            for (n, change) in change.into_iter().take(6).enumerate() {
                carried.z[n] = carried.sums[n].add(carried.z[n], change);
            }
            self.direction.restore_lengths(carried);
            carried.inverse = 1.0 / self.direction.coefficients.denominator(carried.z[2]);
        }
        carried.steps += u64::from(steps);
    }

    fn directions(&self, carried: &Self::Carried) -> [Direction<f64>; 2] {
        self.direction.directions(carried)
    }

    fn state(&self, carried: &Self::Carried) -> State<f64> {
        self.direction.state(carried)
    }

    fn bits(carried: &Self::Carried, feed: impl FnMut(u64)) {
        DirectionForm::<f64, S, Divided>::bits(carried, feed);
    }

    type Saved = [u64; 15];

    fn save(&self, carried: &Self::Carried) -> Self::Saved {
        self.check().save(|feed| Self::bits(carried, feed))
    }

    fn restore(&self, saved: &[u64]) -> Result<Self::Carried, RestoreError> {
        self.direction.restore_checked(self.check(), saved)
    }
}
