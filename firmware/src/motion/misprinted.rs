//! The motion by the equal-rod equations that the page prints.

use double_pendulum::{Parameters, Real, State, rk4};

use crate::config::{DT, STEPS_PER_TICK};
use crate::graphics::RodDirections;

/// The denominator of a2' lacks the factor mu = m2/m1, so rod 2 turns mu times as fast as it should. Unless mu = 1 the equations
/// are not Hamilton's of anything, and what should be the energy is not kept.
///
/// With q = p/(m1 l^2), r = 1/(1 + mu sin^2 D), D = a1 - a2, G = g/l:
///
/// - a1' = u = (q1 - q2 cos D) r; a2' = v = (q2 (1 + mu) - q1 mu cos D) r
/// - q1' = -(1 + mu) G sin a1 - F; q2' = -mu G sin a2 + F
///
/// F = u v sin D is, term by term, the two long fractions of the page in one. Where mu is above 10 or so, rod 2 turns so fast
/// that no step here resolves it. Plain `f32` is right to half a pixel at figure 7 for 10 s (test `misprint`).
#[derive(Clone, Copy, Debug)]
pub struct Misprinted {
    mass_ratio: f32,
    /// G, 1/s^2.
    gravity: f32,
    /// m1 l^2, kg m^2.
    inertia: f32,
    /// sin a1, cos a1, sin D, cos D, q1, q2 (1/s): nothing here needs an angle.
    z: [f32; 6],
}

impl Misprinted {
    /// Equal rods, let go at `start`.
    pub fn new(
        &Parameters {
            m1, m2, l1: l, g, ..
        }: &Parameters<f32>,
        start: &State<f32>,
    ) -> Self {
        let inertia = m1 * l * l;
        let (sin1, cos1) = start.a1.own_sin_cos();
        let (sin_d, cos_d) = (start.a1 - start.a2).own_sin_cos();
        let z = [
            sin1,
            cos1,
            sin_d,
            cos_d,
            start.p1 / inertia,
            start.p2 / inertia,
        ];
        Self {
            mass_ratio: m2 / m1,
            gravity: g / l,
            inertia,
            z,
        }
    }

    pub fn tick(&mut self) {
        for _ in 0..STEPS_PER_TICK {
            self.z = rk4::step(|z| self.rates(z), &self.z, DT as f32);
        }
        let [sin1, cos1, sin_d, cos_d, q1, q2] = self.z;
        let ([sin1, cos1], [sin_d, cos_d]) = (unit([sin1, cos1]), unit([sin_d, cos_d]));
        self.z = [sin1, cos1, sin_d, cos_d, q1, q2];
    }

    pub fn directions(&self) -> RodDirections {
        let [sin1, cos1, sin_d, cos_d, ..] = self.z;
        [
            [sin1, cos1],
            [sin1 * cos_d - cos1 * sin_d, cos1 * cos_d + sin1 * sin_d],
        ]
    }

    /// The energy H, J, as [`Pendulum::energy`](double_pendulum::Pendulum::energy) has it:
    /// ((q1 - q2 cos D)^2 r + q2^2/mu)/2 - (1 + mu) G cos a1 - mu G cos a2, times m1 l^2.
    pub fn energy(&self) -> f32 {
        let &Self {
            mass_ratio: mu,
            gravity,
            inertia,
            z: [_, _, sin_d, cos_d, q1, q2],
        } = self;
        let [[_, cos1], [_, cos2]] = self.directions();
        let q = q1 - q2 * cos_d;
        let kinetic = 0.5 * (q * q / (1.0 + mu * sin_d * sin_d) + q2 * q2 / mu);
        inertia * (kinetic - gravity * ((1.0 + mu) * cos1 + mu * cos2))
    }

    fn rates(&self, &[sin1, cos1, sin_d, cos_d, q1, q2]: &[f32; 6]) -> [f32; 6] {
        let &Self {
            mass_ratio: mu,
            gravity,
            ..
        } = self;
        let r = 1.0 / (1.0 + mu * sin_d * sin_d);
        let (u, v) = (
            (q1 - q2 * cos_d) * r,
            (q2 * (1.0 + mu) - q1 * mu * cos_d) * r,
        );
        let (w, force) = (u - v, u * v * sin_d);
        let sin2 = sin1 * cos_d - cos1 * sin_d;
        let [torque1, torque2] = [(1.0 + mu) * gravity * sin1, mu * gravity * sin2];
        [
            cos1 * u,
            -sin1 * u,
            cos_d * w,
            -sin_d * w,
            -torque1 - force,
            force - torque2,
        ]
    }
}

/// A direction made as long as 1 again, to first order in what it misses.
fn unit([sin, cos]: [f32; 2]) -> [f32; 2] {
    let gain = 1.5 - 0.5 * (sin * sin + cos * cos);
    [gain * sin, gain * cos]
}
