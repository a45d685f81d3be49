//! The direction form: classical RK4 on (sin a1, cos a1, sin D, cos D, p1, p2), without trigonometry.

use core::marker::PhantomData;

use super::classical::{self, Point};
use super::coefficients::{Scale, Span, prepare, third};
use super::lead::BLOCK;
use super::sum::{Compensated, Sum};
use crate::error::{Error, Parameter, check_finite};
use crate::methods::{Form, Side};
use crate::numbers::{Real, Sealed};
use crate::pendulum::directions::{Coefficients, heads, lower_direction};
use crate::pendulum::{Direction, Parameters, State};

/// The directions of the rods themselves are stepped: what a drawing needs, and no angle anywhere.
///
/// (sin a)' = a' cos a, (cos a)' = -a' sin a for a1 and for D = a1 - a2. The method's error is that of RK4 on angles
/// within a factor of three, smaller near the upright position. What it does to the length of the directions, a relative
/// (w dt)^6/72 a step, is undone every 32 steps. Angles are read off within (-pi, pi]; [`Run`](crate::Run) counts
/// the turns where they are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionForm<R, S = Compensated<R>> {
    pub(super) coefficients: Coefficients<R>,
    scale: Scale,
    /// 1/(2 nu^2).
    pub(super) half_inverse_square: R,
    sum: PhantomData<S>,
}

/// What the direction form carries from step to step: 64 bytes in compensated `f32`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionState<R, S> {
    /// sin a1, cos a1, S, C, P1, P2.
    pub(super) z: [R; 6],
    pub(super) sums: [S; 6],
    pub(super) inverse: R,
    pub(super) steps: u64,
}

impl<R: Real, S: Sum<R>> Sealed for DirectionForm<R, S> {}

#[doc(hidden)]
impl<R: Real + Side, S: Sum<R>> Form for DirectionForm<R, S> {
    type Real = R;
    type Carried = DirectionState<R, S>;
    type Side = R;

    fn new(parameters: &Parameters<f64>, dt: f64) -> Result<Self, Error> {
        Self::with_span(parameters, dt, Span::classical::<R>())
    }

    fn start(&self, state: &State<f64>) -> Result<Self::Carried, Error> {
        let state = &state.cast::<R>();
        state.check()?;
        let norm = self.coefficients.norm.to_f64();
        let [a1, a2] = [state.a1.to_f64(), state.a2.to_f64()];
        let (sin1, cos1) = a1.own_sin_cos();
        let (sin_d, cos_d) = (a1 - a2).own_sin_cos();
        let [p1, p2] = self.scale.momenta(state)?;
        let z = [sin1, cos1, norm * sin_d, norm * cos_d, p1, p2];
        let inverse = R::ONE / self.coefficients.denominator(R::from_f64(z[2]));
        Ok(DirectionState { z: z.map(R::from_f64), sums: z.map(S::new), inverse, steps: 0 })
    }

    #[inline(never)]
    fn advance(&self, carried: &mut Self::Carried, steps: u32) {
        let mut left = steps;
        while left > 0 {
            let run = left.min(BLOCK - carried.steps as u32 % BLOCK);
            self.run(carried, run);
            left -= run;
        }
    }

    #[inline(always)]
    fn advance_one(&self, carried: &mut Self::Carried) {
        self.run(carried, 1);
    }

    fn check(&self, carried: &Self::Carried) -> Result<(), Error> {
        let [sin1, cos1, s, c, p1, p2] = carried.z;
        let [_, [sin2, cos2]] = self.directions::<R>(carried);
        let rods = [(Parameter::A1, [sin1, cos1]), (Parameter::A2, [s, c]), (Parameter::A2, [sin2, cos2])];
        let rods = rods.into_iter().flat_map(|(parameter, numbers)| numbers.map(|number| (parameter, number)));
        let unit = R::from_f64(self.scale.momentum);
        check_finite(rods.chain([(Parameter::P1, p1 / unit), (Parameter::P2, p2 / unit)])).map_err(Error::diverged)
    }

    #[inline(always)]
    fn heads(carried: &Self::Carried) -> [Direction<R>; 2] {
        heads(&carried.z)
    }

    fn directions<Q: Real>(&self, carried: &Self::Carried) -> [Direction<Q>; 2] {
        let [sin1, cos1, s, c, ..] = carried.z;
        let lower = lower_direction([sin1, cos1], [s, c], self.coefficients.norm);
        [[sin1, cos1], lower].map(|direction| direction.map(R::cast))
    }

    fn momenta<Q: Real>(&self, carried: &Self::Carried) -> [Q; 2] {
        self.scale.in_si([carried.z[4], carried.z[5]]).map(R::cast)
    }

    fn state(&self, carried: &Self::Carried) -> State<f64> {
        self.scale.state(&self.coefficients, &carried.z, carried.sums.map(|sum| sum.lost()), carried.steps)
    }

    fn bits(carried: &Self::Carried, mut feed: impl FnMut(u64)) {
        carried.z.iter().for_each(|z| feed(z.bits()));
        carried.sums.iter().for_each(|sum| feed(sum.lost().bits()));
        feed(carried.inverse.bits());
        feed(carried.steps);
    }
}

impl<R: Real, S: Sum<R>> DirectionForm<R, S> {
    pub(super) fn with_span(parameters: &Parameters<f64>, dt: f64, span: Span) -> Result<Self, Error> {
        let (coefficients, scale) = prepare(&parameters.cast(), dt, span)?;
        let half_inverse_square = R::HALF / (coefficients.norm * coefficients.norm);
        Ok(Self { coefficients, scale, half_inverse_square, sum: PhantomData })
    }

    /// Whether the step that ends at `count` is left out, the last of a block.
    pub(crate) fn leaves_out(&self, count: u64) -> bool {
        self.scale.lead.is_left_out(count)
    }

    /// As this, but every hundredth step is left out.
    #[cfg(test)]
    pub(crate) fn leaving_out_more(mut self) -> Self {
        self.scale.lead = super::lead::Lead::new(1.0, 0.99);
        self
    }

    /// Steps, at most to the end of a block, where the lengths are restored.
    #[inline(always)]
    pub(super) fn run(&self, carried: &mut DirectionState<R, S>, steps: u32) {
        carried.steps += u64::from(steps);
        for _ in 0..self.scale.lead.made(steps, carried.steps) {
            self.step(carried);
        }
        if carried.steps as u32 % BLOCK == 0 {
            self.restore_lengths(carried);
        }
    }

    #[inline(always)]
    fn step(&self, carried: &mut DirectionState<R, S>) {
        let DirectionState { z, inverse, .. } = *carried;
        let (sum, last) = classical::stages(&self.coefficients, &Point { z, inverse });
        for i in 0..6 {
            carried.z[i] = carried.sums[i].add(z[i], sum[i] * third());
        }
        carried.inverse = classical::newton_inverse(last, self.coefficients.inertia, carried.z[2]);
    }

    /// Makes sin^2 a1 + cos^2 a1 = 1 and S^2 + C^2 = nu^2 again, to first order in what they miss.
    #[inline(always)]
    pub(super) fn restore_lengths(&self, carried: &mut DirectionState<R, S>) {
        for (i, length, gain) in [(0, R::ONE, R::HALF), (2, self.coefficients.norm, self.half_inverse_square)] {
            let [s, c] = [carried.z[i], carried.z[i + 1]];
            let lost = s * carried.sums[i].lost() + c * carried.sums[i + 1].lost();
            let missing = classical::missing([s, c], lost, length, gain);
            carried.z[i] = carried.sums[i].add(s, s * missing);
            carried.z[i + 1] = carried.sums[i + 1].add(c, c * missing);
        }
    }
}
