//! The motion by the equal-rod equations that the page prints, in fixed point.

use core::num::Wrapping;

use double_pendulum::trig::{Own, SinCos};
use double_pendulum::{Parameters, State};

use super::direction_stepper::Directions;
use crate::config::{DT, STEPS_PER_TICK};

/// The unit of time, s: half a step, with which both bobs of figure 7 are right to half a pixel for 10 s (test `misprint`).
const UNIT: f32 = 0.5 * DT as f32;

/// A number in fixed point; sums and products beyond its range wrap.
type Number = Wrapping<i32>;
/// The binary places of directions and rates, which are below 2, ...
const PLACES: u32 = 30;
/// ... of momenta, below 1/2, ...
const MOMENTUM_PLACES: u32 = 32;
/// ... of mass ratios, below 128, ...
const MASS_PLACES: u32 = 24;
/// ... and of torques of gravity, below 1/8.
const GRAVITY_PLACES: u32 = 34;

/// The denominator of a2' lacks the factor mu = m2/m1, so rod 2 turns mu times as fast as it should. Unless mu = 1 the equations
/// are not Hamilton's of anything, and what should be the energy is not kept.
///
/// With q = p/(m1 l^2), r = 1/(1 + mu sin^2 D), D = a1 - a2:
///
/// - a1' = u = (q1 - q2 cos D) r; a2' = v = (q2 (1 + mu) - q1 mu cos D) r = mu (q2 - q1 cos D) r + q2 r
/// - q1' = -(1 + mu) g/l sin a1 - F; q2' = -mu g/l sin a2 + F
///
/// F = u v sin D is, term by term, the two long fractions of the page in one. Where mu is above 10 or so, rod 2 turns so fast
/// that no step here resolves it.
#[derive(Clone, Copy, Debug)]
pub struct Misprinted {
    mass_ratio: Number,
    /// (1 + mu) g/l and mu g/l.
    gravity: [Number; 2],
    /// m1 l^2, J for numbers without a unit.
    inertia: f32,
    /// sin a1, cos a1, sin D, cos D, q1, q2: nothing here needs an angle.
    z: [Number; 6],
}

impl Misprinted {
    /// Equal rods, let go at `start`.
    pub fn new(&Parameters { m1, m2, l1: l, g, .. }: &Parameters<f32>, start: &State<f32>) -> Self {
        let (mu, inertia) = (m2 / m1, m1 * l * l / UNIT);
        let (sin1, cos1) = Own::sin_cos(start.a1);
        let (sin_d, cos_d) = Own::sin_cos(start.a1 - start.a2);
        let torque = g / l * UNIT * UNIT;
        Self {
            mass_ratio: number(mu, MASS_PLACES),
            gravity: [(1.0 + mu) * torque, mu * torque].map(|torque| number(torque, GRAVITY_PLACES)),
            inertia: inertia / UNIT,
            z: [
                number(sin1, PLACES),
                number(cos1, PLACES),
                number(sin_d, PLACES),
                number(cos_d, PLACES),
                number(start.p1 / inertia, MOMENTUM_PLACES),
                number(start.p2 / inertia, MOMENTUM_PLACES),
            ],
        }
    }

    /// Advances by one tick.
    pub fn tick(&mut self) {
        for _ in 0..STEPS_PER_TICK {
            self.step();
        }
        let [sin1, cos1, sin_d, cos_d, q1, q2] = self.z;
        let ([sin1, cos1], [sin_d, cos_d]) = (unit([sin1, cos1]), unit([sin_d, cos_d]));
        self.z = [sin1, cos1, sin_d, cos_d, q1, q2];
    }

    /// Where the rods point.
    pub fn directions(&self) -> Directions {
        let [sin1, cos1, ..] = self.z;
        [[sin1, cos1], self.direction2()].map(|direction| direction.map(|part| float(part, PLACES)))
    }

    /// The energy H, J, as [`Pendulum::energy`](double_pendulum::Pendulum::energy) has it:
    /// ((q1 - q2 cos D)^2 r + q2^2/mu)/2 - (1 + mu) g/l cos a1 - mu g/l cos a2, times m1 l^2.
    pub fn energy(&self) -> f32 {
        let &Self { mass_ratio: mu, gravity: [gravity1, gravity2], z: [_, cos1, sin_d, cos_d, q1, q2], .. } = self;
        let [_, cos2] = self.direction2();
        let q = q1 - times(q2, cos_d);
        let upper = times(product(q, q, MOMENTUM_PLACES), self.inverse(sin_d));
        let lower = product(q2, q2, MOMENTUM_PLACES);
        let depth = torque(gravity1, cos1) + torque(gravity2, cos2);
        let [upper, lower, depth] = [upper, lower, depth].map(|part| float(part, MOMENTUM_PLACES));
        self.inertia * (0.5 * (upper + lower / float(mu, MASS_PLACES)) - depth)
    }

    /// By the classical Runge-Kutta method, as [`double_pendulum::rk4::step`].
    fn step(&mut self) {
        const THIRD: Number = Wrapping((1 << PLACES) / 3);
        let z = self.z;
        let after = |k: [Number; 6]| core::array::from_fn(|i| z[i] + k[i]);
        let k1 = self.rates(&z);
        let k2 = self.rates(&after(k1));
        let k3 = self.rates(&after(k2));
        let k4 = self.rates(&after(k3.map(|k| k + k)));
        self.z = core::array::from_fn(|i| {
            let (ends, middle) = (k1[i] + k4[i], k2[i] + k3[i]);
            z[i] + times(THIRD, ends) + times(THIRD + THIRD, middle)
        });
    }

    fn rates(&self, &[sin1, cos1, sin_d, cos_d, q1, q2]: &[Number; 6]) -> [Number; 6] {
        let &Self { mass_ratio: mu, gravity: [gravity1, gravity2], .. } = self;
        let r = self.inverse(sin_d);
        let u = product(q1 - times(q2, cos_d), r, MOMENTUM_PLACES);
        let elbow = times(q2 - times(q1, cos_d), r);
        let v = product(mu, elbow, MASS_PLACES + MOMENTUM_PLACES - PLACES) + product(q2, r, MOMENTUM_PLACES);
        let force = times(product(u, v, 2 * PLACES - MOMENTUM_PLACES), sin_d);
        let sin2 = times(sin1, cos_d) - times(cos1, sin_d);
        let w = u - v;
        let [torque1, torque2] = [torque(gravity1, sin1), torque(gravity2, sin2)];
        [times(cos1, u), -times(sin1, u), times(cos_d, w), -times(sin_d, w), -torque1 - force, force - torque2]
    }

    /// r = 1/(1 + mu sin^2 D): half of its digits by a division, the others by a step of Newton's.
    fn inverse(&self, sin_d: Number) -> Number {
        let inertia = Wrapping(1 << MASS_PLACES) + times(self.mass_ratio, times(sin_d, sin_d));
        let quotient = (1_u32 << 31).checked_div(inertia.0 as u32 >> 8).unwrap_or_default();
        let r = Wrapping((quotient << 15) as i32);
        r + times(r, Wrapping(1 << PLACES) - product(inertia, r, MASS_PLACES))
    }

    fn direction2(&self) -> [Number; 2] {
        let [sin1, cos1, sin_d, cos_d, ..] = self.z;
        [times(sin1, cos_d) - times(cos1, sin_d), times(cos1, cos_d) + times(sin1, sin_d)]
    }
}

/// A direction made as long as 1 again, to first order in what it misses.
fn unit([sin, cos]: [Number; 2]) -> [Number; 2] {
    const THREE_HALVES: Number = Wrapping(3 << (PLACES - 1));
    let gain = THREE_HALVES - product(sin, sin, PLACES + 1) - product(cos, cos, PLACES + 1);
    [times(gain, sin), times(gain, cos)]
}

fn number(value: f32, places: u32) -> Number {
    Wrapping((value * (1_u64 << places) as f32) as i32)
}

fn float(number: Number, places: u32) -> f32 {
    number.0 as f32 / (1_u64 << places) as f32
}

/// The product with a direction or a rate.
fn times(a: Number, b: Number) -> Number {
    product(a, b, PLACES)
}

/// The torque of gravity in a direction.
fn torque(gravity: Number, direction: Number) -> Number {
    product(gravity, direction, GRAVITY_PLACES + PLACES - MOMENTUM_PLACES)
}

/// The product shifted right by `places` bits, rounded to nearest.
fn product(a: Number, b: Number, places: u32) -> Number {
    let half = 1 << (places - 1);
    Wrapping(((i64::from(a.0) * i64::from(b.0) + half) >> places) as i32)
}
