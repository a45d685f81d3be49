//! The direction form by extrapolation: the exact motion to the last digits of an `f64`, cheaply.

use super::Sum;
use crate::error::Error;
use crate::methods::extrapolation::{Extrapolation, ROWS, System};
use crate::methods::{DirectionF64, Form};
use crate::numbers::{Lanes, Real, Sealed};
use crate::pendulum::directions::{Coefficients, Units, increments};
use crate::pendulum::{Direction, Parameters, State};

/// As [`DirectionF32`](crate::DirectionF32) in compensated `f64`, but each step by [`Extrapolation`] of order `ORDER`, 2, 4
/// .. 16, after which the lengths of the directions are restored. Four rows go through the step side by side, in the vectors of processors that have them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtrapolationF64<const ORDER: u32> {
    direction: DirectionF64,
    method: Extrapolation<f64>,
}

/// Rows side by side: two vectors of SSE2 hide each other's latency.
const LANES: usize = 4;

type Numbers = Lanes<f64, LANES>;

/// The equations where the lanes are.
struct Rows<'a> {
    z: &'a [f64; 6],
    step: &'a Coefficients<f64>,
    paced: Coefficients<Numbers>,
    pace: Pace,
}

/// Rates times the share of the step between every second midpoint.
#[derive(Clone, Copy)]
struct Pace(Numbers);

impl Units<Numbers> for Pace {
    #[inline(always)]
    fn paced(&self, u: Numbers) -> Numbers {
        self.0 * u
    }
    #[inline(always)]
    fn turns(&self, [u, v]: [Numbers; 2]) -> [Numbers; 2] {
        [u, self.0 * v]
    }
}

impl<'a> Rows<'a> {
    fn new(z: &'a [f64; 6], step: &'a Coefficients<f64>) -> Self {
        Self {
            z,
            step,
            paced: step.splat(),
            pace: Pace(Lanes::splat(1.0)),
        }
    }
}

impl System<f64, LANES, 6> for Rows<'_> {
    #[inline(always)]
    fn turn_to(&mut self, rows: [usize; LANES]) {
        const SHARES: [f64; ROWS] = [1.0, 0.5, 1.0 / 3.0, 0.25, 0.2, 1.0 / 6.0, 1.0 / 7.0, 0.125];
        let shares = Lanes(rows.map(|row| SHARES[row % ROWS]));
        self.pace = Pace(shares);
        self.paced.gravity = self
            .step
            .gravity
            .map(|gravity| Lanes::splat(gravity) * shares);
    }

    #[inline(always)]
    fn slope(&mut self, at: &[Numbers; 6]) -> [Numbers; 6] {
        let z: [Numbers; 6] = core::array::from_fn(|i| Lanes::splat(self.z[i]) + at[i]);
        let inverse = Lanes(
            self.paced
                .denominator(z[2])
                .0
                .map(|denominator| 1.0 / denominator),
        );
        increments(&z, self.paced.rates(&self.pace, &z, inverse))
    }
}

impl<const ORDER: u32> Sealed for ExtrapolationF64<ORDER> {}

#[doc(hidden)]
impl<const ORDER: u32> Form for ExtrapolationF64<ORDER> {
    type Real = f64;
    type Side = f64;

    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        let direction = DirectionF64::with_step(parameters, start, dt, 1.0)?;
        Ok(Self {
            direction,
            method: Extrapolation::new(ORDER)?,
        })
    }

    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        Ok(Self {
            direction: self.direction.started(start)?,
            ..*self
        })
    }

    // A call is nothing beside such a step: never inlined, to avoid a second copy.
    #[inline(never)]
    fn advance(&mut self, steps: u32) {
        let Self { direction, method } = self;
        for _ in 0..steps {
            let change = method.end(
                &mut Rows::new(&direction.at.z, &direction.coefficients),
                &[0.0; 6],
            );
            for (n, change) in change.into_iter().enumerate() {
                direction.at.z[n] = direction.sums[n].add(direction.at.z[n], change);
            }
            direction.restore_lengths();
        }
        direction.at.inverse = 1.0 / direction.coefficients.denominator(direction.at.z[2]);
        direction.steps += u64::from(steps);
    }

    fn check(&self) -> Result<(), Error> {
        self.direction.check()
    }

    fn rod_directions(&self) -> [Direction<f64>; 2] {
        self.direction.rod_directions()
    }

    fn directions<Q: Real>(&self) -> [Direction<Q>; 2] {
        self.direction.directions()
    }

    fn momenta<Q: Real>(&self) -> [Q; 2] {
        self.direction.momenta()
    }

    fn state(&self) -> State<f64> {
        self.direction.state()
    }

    fn bits(&self, feed: impl FnMut(u64)) {
        self.direction.bits(feed);
    }
}
