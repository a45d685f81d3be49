//! The direction form in floating point: RK4 and extrapolation, of one motion or of many side by side.

mod classical;
mod coefficients;
mod extrapolated;

pub(crate) use classical::DirectionLanes;
#[cfg(test)]
pub(crate) use coefficients::Lead;
pub(crate) use coefficients::{BLOCK, Scale, classical_step, prepare};
pub use extrapolated::ExtrapolationF64;

use core::fmt::Debug;

use crate::error::{Error, Parameter, check_finite};
use crate::methods::{Form, Side};
use crate::numbers::{Real, Scalar, Sealed};
use crate::pendulum::directions::{Coefficients, directions, quantities, rod_directions};
use crate::pendulum::{Direction, Parameters, State};
use classical::Point;

/// The directions of the rods themselves are stepped: what a drawing needs, and no angle anywhere.
///
/// (sin a)' = a' cos a, (cos a)' = -a' sin a for a1 and for D = a1 - a2. The method's error is that of RK4 on angles
/// within a factor of three, smaller near the upright position. What it does to the length of the directions, a relative
/// (w dt)^6/72 a step, is undone every 32 steps. Angles are read off within (-pi, pi]; [`Run`](crate::Run) counts
/// the turns where they are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionForm<R, S = Compensated<R>> {
    coefficients: Coefficients<R>,
    scale: Scale,
    /// 1/(2 nu^2).
    half_inverse_square: R,
    at: Point<R>,
    /// Of z.
    sums: [S; 6],
    steps: u64,
}

impl<R: Real, S: Sum<R>> Sealed for DirectionForm<R, S> {}

#[doc(hidden)]
impl<R: Real + Side, S: Sum<R>> Form for DirectionForm<R, S> {
    type Real = R;
    type Side = R;

    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error> {
        Self::with_step(parameters, start, dt, classical_step::<R>())
    }

    fn started(&self, start: &State<f64>) -> Result<Self, Error> {
        let start = start.cast::<R>();
        start.check()?;
        let z = quantities(
            &start.cast(),
            self.coefficients.norm.to_f64(),
            [self.scale.momentum; 2],
        );
        self.scale.check::<R>([z[4], z[5]])?;
        let inverse = R::ONE / self.coefficients.denominator(R::from_f64(z[2]));
        Ok(Self {
            at: Point {
                z: z.map(R::from_f64),
                inverse,
            },
            sums: z.map(S::new),
            steps: 0,
            ..*self
        })
    }

    #[inline(never)]
    fn advance(&mut self, steps: u32) {
        let mut left = steps;
        while left > 0 {
            let run = left.min(BLOCK - self.steps as u32 % BLOCK);
            self.run(run);
            left -= run;
        }
    }

    #[inline(always)]
    fn advance_one(&mut self) {
        self.run(1);
    }

    fn check(&self) -> Result<(), Error> {
        let [sin1, cos1, s, c, p1, p2] = self.at.z;
        let [_, [sin2, cos2]] = self.directions::<R>();
        let rods = [
            (Parameter::A1, [sin1, cos1]),
            (Parameter::A2, [s, c]),
            (Parameter::A2, [sin2, cos2]),
        ];
        let rods = rods
            .into_iter()
            .flat_map(|(parameter, numbers)| numbers.map(|number| (parameter, number)));
        let unit = R::from_f64(self.scale.momentum);
        check_finite(rods.chain([(Parameter::P1, p1 / unit), (Parameter::P2, p2 / unit)]))
            .map_err(Error::diverged)
    }

    #[inline(always)]
    fn rod_directions(&self) -> [Direction<R>; 2] {
        rod_directions(&self.at.z)
    }

    fn directions<Q: Real>(&self) -> [Direction<Q>; 2] {
        directions(&self.at.z, self.coefficients.norm).map(|direction| direction.map(R::cast))
    }

    fn momenta<Q: Real>(&self) -> [Q; 2] {
        [self.at.z[4], self.at.z[5]].map(|p| R::from_f64(p.to_f64() / self.scale.momentum).cast())
    }

    fn state(&self) -> State<f64> {
        self.scale.state(
            &self.coefficients,
            &self.at.z,
            self.sums.map(|sum| sum.lost()),
            self.steps,
        )
    }

    fn bits(&self, mut feed: impl FnMut(u64)) {
        self.at.z.iter().for_each(|z| feed(z.bits()));
        self.sums.iter().for_each(|sum| feed(sum.lost().bits()));
        feed(self.at.inverse.bits());
        feed(self.steps);
    }
}

impl<R: Real + Side, S: Sum<R>> DirectionForm<R, S> {
    /// The step of `dt` s goes `step` tau.
    fn with_step(
        parameters: &Parameters<f64>,
        start: &State<f64>,
        dt: f64,
        step: f64,
    ) -> Result<Self, Error> {
        let (coefficients, scale) = prepare(&parameters.cast(), dt, step)?;
        let half_inverse_square = R::HALF / (coefficients.norm * coefficients.norm);
        let at = Point {
            z: [R::ZERO; 6],
            inverse: R::ZERO,
        };
        Self {
            coefficients,
            scale,
            half_inverse_square,
            at,
            sums: [S::new(0.0); 6],
            steps: 0,
        }
        .started(start)
    }

    /// Steps, at most to the end of a block, where the lengths are restored.
    #[inline(always)]
    fn run(&mut self, steps: u32) {
        self.steps += u64::from(steps);
        for _ in 0..self.scale.lead.made(steps, self.steps) {
            self.at.step(&self.coefficients, &mut self.sums);
        }
        if self.steps as u32 % BLOCK == 0 {
            self.restore_lengths();
        }
    }

    #[inline(always)]
    fn restore_lengths(&mut self) {
        self.at.restore_lengths(
            self.coefficients.norm,
            self.half_inverse_square,
            &mut self.sums,
        );
    }
}

/// A running sum, by which increments are added to a state. The number itself is kept elsewhere; what its additions lose is kept
/// here.
pub trait Sum<R>: Copy + Debug + PartialEq + 'static {
    /// For a sum that starts at `value`, of which the number keeps as many digits as it has.
    fn new(value: f64) -> Self;
    /// `number` + `increment`.
    fn add(&mut self, number: R, increment: R) -> R;
    /// What the number lacks.
    fn lost(&self) -> R;
}

/// Adds. Each addition rounds, and the error of n of them grows at least like sqrt(n).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plain;

impl<R: Scalar> Sum<R> for Plain {
    #[inline]
    fn new(_: f64) -> Self {
        Self
    }
    #[inline(always)]
    fn add(&mut self, number: R, increment: R) -> R {
        number + increment
    }
    #[inline(always)]
    fn lost(&self) -> R {
        R::from_f64(0.0)
    }
}

/// Carries the rounding error of each addition into the next, so that it does not grow with their number.
///
/// Three additions more for each. Source: W. Kahan, "Further remarks on reducing truncation errors", CACM 8, 1965.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compensated<R>(R);

impl<R: Real> Sum<R> for Compensated<R> {
    #[inline]
    fn new(value: f64) -> Self {
        Self(R::from_f64(value - R::from_f64(value).to_f64()))
    }
    #[inline(always)]
    fn add(&mut self, number: R, increment: R) -> R {
        let wished = increment + self.0;
        let sum = number + wished;
        self.0 = wished - (sum - number);
        sum
    }
    #[inline(always)]
    fn lost(&self) -> R {
        self.0
    }
}
