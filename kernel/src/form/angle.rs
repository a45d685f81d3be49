//! The angle form: classical RK4 on (a1, a2, p1, p2), with one sine and cosine to the angle and step.

use core::marker::PhantomData;

use super::coefficients::{Coefficients, Rates, Scale, Span, prepare, third};
use super::sum::{Compensated, Sum};
use super::turn::{LARGEST, SMALL, Turn, angle, turned};
use super::{Direction, Form, lower_direction};
use crate::error::{Error, Parameter};
use crate::params::Parameters;
use crate::real::Real;
use crate::state::State;

/// Exactly the classical method on the canonical state, fast.
///
/// Runge-Kutta methods keep linear relations, so RK4 on (a1, D = a1 - a2, p1, p2) is RK4 on (a1, a2, p1, p2). At the
/// stages the directions of a1 and D are turned by the small increment rather than computed anew. A step whose
/// increments leave the range of those small turns, 0.09 rad, is done over with the full sine and cosine.
///
/// Agrees with [`Pendulum::step`](crate::Pendulum::step) to 1e-12 in `f64` over 100 s of regular motion (test `forms`).
#[derive(Clone, Copy, Debug)]
pub struct AngleForm<R, S = Compensated<R>> {
    coefficients: Coefficients<R>,
    scale: Scale,
    sum: PhantomData<S>,
}

/// What the angle form carries from step to step: 64 bytes in compensated `f32`.
#[derive(Clone, Copy, Debug)]
pub struct Angles<R, S> {
    upper: Turn<R, S>,
    elbow: Turn<R, S>,
    momenta: [R; 2],
    sums: [S; 2],
    steps: u64,
}

impl<R: Real, S: Sum<R>> Angles<R, S> {
    /// Adds the increments of a1, D, P1 and P2.
    #[inline(always)]
    fn add(&mut self, [a1, d, p1, p2]: [R; 4]) {
        self.upper.add(a1);
        self.elbow.add(d);
        self.momenta = [self.sums[0].add(self.momenta[0], p1), self.sums[1].add(self.momenta[1], p2)];
    }
}

impl<R: Real, S: Sum<R>> Form<R> for AngleForm<R, S> {
    type Carried = Angles<R, S>;

    fn new(parameters: &Parameters<R>, dt: R) -> Result<Self, Error> {
        let (coefficients, scale) = prepare(parameters, dt, Span::classical::<R>())?;
        Ok(Self { coefficients, scale, sum: PhantomData })
    }

    fn start(&self, state: &State<R>) -> Result<Self::Carried, Error> {
        state.check()?;
        let [a1, a2] = [state.a1.to_f64(), state.a2.to_f64()];
        for (parameter, value) in [(Parameter::A1, a1), (Parameter::A2, a2)] {
            if value.abs() > LARGEST / 2.0 {
                return Err(Error::OutOfRange { parameter, value });
            }
        }
        let momenta = self.scale.momenta(state)?;
        Ok(Angles {
            upper: Turn::new(a1, R::ONE),
            elbow: Turn::new(a1 - a2, self.coefficients.norm),
            momenta: momenta.map(R::of),
            sums: momenta.map(S::new),
            steps: 0,
        })
    }

    #[inline]
    fn advance(&self, carried: &mut Self::Carried, steps: u32) {
        for _ in 0..steps {
            self.step(carried);
        }
        carried.steps += u64::from(steps);
    }

    fn directions(&self, carried: &Self::Carried) -> [Direction<R>; 2] {
        let upper = carried.upper.direction();
        [upper, lower_direction(upper, carried.elbow.direction(), self.coefficients.norm)]
    }

    fn state(&self, carried: &Self::Carried) -> State<f64> {
        let upper = carried.upper.parts();
        let elbow = carried.elbow.parts();
        let lower = (upper.0.wrapping_sub(elbow.0), upper.1 - elbow.1);
        let momenta = [0, 1].map(|i| carried.momenta[i].to_f64() + carried.sums[i].lost().to_f64());
        let rates = self.rates(carried.upper.direction(), carried.elbow.direction(), carried.momenta);
        self.scale.state([angle(upper), angle(lower)], momenta, rates, carried.steps)
    }

    fn bits(carried: &Self::Carried, mut feed: impl FnMut(u64)) {
        carried.upper.bits(&mut feed);
        carried.elbow.bits(&mut feed);
        carried.momenta.iter().for_each(|p| feed(p.bits()));
        carried.sums.iter().for_each(|sum| feed(sum.lost().bits()));
    }
}

/// The square of the largest increment that is a small turn.
const REACH: f64 = SMALL * SMALL;

/// A remainder from a mark counts double: beyond 0.045 rad it moves to a nearer mark.
const REST: f64 = 1.5;

impl<R: Real, S: Sum<R>> AngleForm<R, S> {
    /// One step. Whether all was small is asked once, at its end.
    #[inline(always)]
    fn step(&self, carried: &mut Angles<R, S>) {
        let upper = carried.upper.direction();
        let elbow = carried.elbow.direction();
        let mut reach = R::ZERO;
        let increment = self.increment(carried, |[a1, d]| {
            reach += a1 * a1 + d * d;
            [turned(upper, a1), turned(elbow, d)]
        });
        let mut next = *carried;
        next.add(increment);
        let [rest1, rest2] = [next.upper.rest(), next.elbow.rest()];
        if reach + R::of(REST) * (rest1 * rest1 + rest2 * rest2) <= R::of(REACH) {
            *carried = next;
        } else {
            self.careful_step(carried, increment, reach);
        }
    }

    /// A step that turns far or ends far from a mark; also where a value is not a number.
    #[cold]
    #[inline(never)]
    fn careful_step(&self, carried: &mut Angles<R, S>, increment: [R; 4], reach: R) {
        carried.add(if reach <= R::of(REACH) {
            increment
        } else {
            self.increment(carried, |[a1, d]| [carried.upper.direction_at(a1), carried.elbow.direction_at(d)])
        });
        carried.upper.settle(R::ONE);
        carried.elbow.settle(self.coefficients.norm);
    }

    /// The increments of a1, D, P1 and P2 over one step; `further` gives both directions some increments of a1 and D on.
    #[inline(always)]
    fn increment(&self, carried: &Angles<R, S>, mut further: impl FnMut([R; 2]) -> [Direction<R>; 2]) -> [R; 4] {
        let [p1, p2] = carried.momenta;
        let mut stage = |k: &[R; 4]| {
            let [upper, elbow] = further([k[0], k[1]]);
            increments(self.rates(upper, elbow, [p1 + k[2], p2 + k[3]]))
        };
        let k1 = increments(self.rates(carried.upper.direction(), carried.elbow.direction(), carried.momenta));
        let k2 = stage(&k1);
        let sum: [R; 4] = core::array::from_fn(|i| k1[i] + (k2[i] + k2[i]));
        let twice_k3 = stage(&k2).map(|k| k + k);
        let sum: [R; 4] = core::array::from_fn(|i| sum[i] + twice_k3[i]);
        let k4 = stage(&twice_k3);
        core::array::from_fn(|i| (sum[i] + k4[i]) * third())
    }

    #[inline(always)]
    fn rates(&self, upper: Direction<R>, elbow: Direction<R>, momenta: [R; 2]) -> Rates<R> {
        self.coefficients.rates(upper, elbow, momenta, R::ONE / self.coefficients.denominator(elbow[0]))
    }
}

/// The rates of a1, D, P1 and P2.
#[inline(always)]
fn increments<R: Real>(Rates { angles: [u, v], momenta: [p1, p2] }: Rates<R>) -> [R; 4] {
    [u, u - v, p1, p2]
}
