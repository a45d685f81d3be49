//! The motion by the equations for equal rods as the page prints them.

use double_pendulum::{Parameters, State, rk4, sin_cos};

use crate::config::{DT, STEPS_PER_TICK};
use crate::graphics::RodDirections;

/// A motion by the misprinted equations, in steps of RK4 in plain `f32`.
///
/// The denominator of a2' lacks the factor mu = m2/m1, so that rod 2 turns mu times as fast as it
/// should. Unless mu = 1, the equations are not Hamilton's equations of any system, and the energy
/// is not conserved.
///
/// With q = p/(m1 l^2), r = 1/(1 + mu sin^2 D), D = a1 - a2, G = g/l:
///
/// - a1' = u = (q1 - q2 cos D) r; a2' = v = (q2 (1 + mu) - q1 mu cos D) r
/// - q1' = -(1 + mu) G sin a1 - F; q2' = -mu G sin a2 + F
///
/// F = u v sin D is equal, term by term, to the two long fractions of the page. If mu is above 10
/// or so, rod 2 turns so fast that no step of this module resolves it. For figure 7, plain `f32` is
/// accurate to half a pixel for 10 s (test `misprint`).
#[derive(Clone, Copy, Debug)]
pub struct Misprinted {
    mass_ratio: f32,
    /// G, 1/s^2.
    gravity: f32,
    /// m1 l^2, kg m^2.
    inertia: f32,
    /// sin a1, cos a1, sin D, cos D, q1, q2 (1/s). The equations need no angle.
    z: [f32; 6],
    /// True if the rods were ever too fast for the steps. Then `z` stays as it was before.
    is_lost: bool,
    /// The number of steps that the last tick has tried.
    pub tried: u32,
}

/// The largest number of steps in a tick. It is the limit of a Cortex-M3.
const PARTS: u32 = 4 * STEPS_PER_TICK;

/// The length of the shortest step, s.
const PART: f32 = (DT / 4.0) as f32;

/// The largest rotation of a rod in a step, rad.
const MOST_TURN: f32 = 0.5;

/// The largest error of a squared length in a tick. It bounds how fast the rates change.
const LENGTH_ERROR: f32 = 1e-3;

/// The largest bend of the elbow in a step, rad, times sqrt(1 + mu). The number r changes within an
/// angle of 1/sqrt(1 + mu).
const MOST_BEND: f32 = 1.0;

impl Misprinted {
    /// Creates the motion of equal rods from the canonical state `start`. l2 is taken to be l1.
    pub fn new(
        &Parameters {
            m1, m2, l1: l, g, ..
        }: &Parameters<f32>,
        start: &State<f64>,
    ) -> Self {
        // Everything is divided by m1 l^2 or by the length of the rods.
        let inertia = m1 * l * l;
        let (sin1, cos1) = sin_cos(start.a1);
        let (sin_d, cos_d) = sin_cos(start.a1 - start.a2);
        let [sin1, cos1, sin_d, cos_d, p1, p2] =
            [sin1, cos1, sin_d, cos_d, start.p1, start.p2].map(|number| number as f32);
        let z = [sin1, cos1, sin_d, cos_d, p1 / inertia, p2 / inertia];
        Self {
            mass_ratio: m2 / m1,
            gravity: g / l,
            inertia,
            z,
            is_lost: false,
            tried: 0,
        }
    }

    /// Returns true if the motion became too fast for the shortest step. It stays so.
    pub fn is_lost(&self) -> bool {
        self.is_lost
    }

    /// Advances by one tick, in 2 to 8 steps that resolve the motion at both of their ends. If none
    /// does, the motion is lost, and no longer moves.
    pub fn tick(&mut self) {
        self.tried = 0;
        let mut left = PARTS;
        let mut parts = PARTS / STEPS_PER_TICK;
        while left > 0 {
            if self.is_lost {
                return;
            }
            // Try a step, and halve it until it resolves the motion at both ends.
            self.tried += 1;
            let z = rk4::step(|z| self.rates(z), &self.z, parts as f32 * PART);
            if self.is_resolved(&self.z, parts) && self.is_resolved(&z, parts) {
                self.z = z;
                left -= parts;
            } else if parts > 1 {
                parts /= 2;
            } else {
                self.is_lost = true;
            }
        }

        // Restore the lengths of the directions.
        let [sin1, cos1, sin_d, cos_d, q1, q2] = self.z;
        let [sin1, cos1] = unit([sin1, cos1]);
        let [sin_d, cos_d] = unit([sin_d, cos_d]);
        self.z = [sin1, cos1, sin_d, cos_d, q1, q2];
    }

    /// Returns the directions of both rods.
    pub fn directions(&self) -> RodDirections {
        let [sin1, cos1, sin_d, cos_d, ..] = self.z;
        [
            [sin1, cos1],
            [sin1 * cos_d - cos1 * sin_d, cos1 * cos_d + sin1 * sin_d],
        ]
    }

    /// Returns the energy by the correct formula, J. It is 0 at the height of the pivot.
    pub fn energy(&self) -> f32 {
        let &Self {
            mass_ratio: mu,
            gravity,
            inertia,
            z: [_, _, sin_d, cos_d, q1, q2],
            ..
        } = self;
        let [[_, cos1], [_, cos2]] = self.directions();
        let q = q1 - q2 * cos_d;
        let kinetic = 0.5 * (q * q / (1.0 + mu * sin_d * sin_d) + q2 * q2 / mu);
        inertia * (kinetic - gravity * ((1.0 + mu) * cos1 + mu * cos2))
    }

    /// Returns the angular velocities u of rod 1 and v of rod 2, 1/s.
    fn turning(&self, &[_, _, sin_d, cos_d, q1, q2]: &[f32; 6]) -> [f32; 2] {
        let mu = self.mass_ratio;
        let r = 1.0 / (1.0 + mu * sin_d * sin_d);
        [
            (q1 - q2 * cos_d) * r,
            (q2 * (1.0 + mu) - q1 * mu * cos_d) * r,
        ]
    }

    /// Returns true if a step of this many [`PART`]s resolves the motion near `z`.
    fn is_resolved(&self, z: &[f32; 6], parts: u32) -> bool {
        // The rotations of the rods in the step, and the bend of the elbow.
        let [turn1, turn2] = self.turning(z).map(|rate| rate * (parts as f32 * PART));
        let bend = turn1 - turn2;
        let [sin1, cos1, sin_d, cos_d, ..] = *z;
        let is_unit = |sin: f32, cos: f32| (sin * sin + cos * cos - 1.0).abs() <= LENGTH_ERROR;
        is_unit(sin1, cos1)
            && is_unit(sin_d, cos_d)
            && turn1.abs() <= MOST_TURN
            && turn2.abs() <= MOST_TURN
            && bend * bend * (1.0 + self.mass_ratio) <= MOST_BEND * MOST_BEND
    }

    /// Returns the rates of change of `z`.
    fn rates(&self, z: &[f32; 6]) -> [f32; 6] {
        let &Self {
            mass_ratio: mu,
            gravity,
            ..
        } = self;
        let [sin1, cos1, sin_d, cos_d, ..] = *z;
        let [u, v] = self.turning(z);
        let w = u - v;
        // F acts on both rods with opposite signs.
        let force = u * v * sin_d;
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

/// Returns a direction with its length restored to 1, to first order in the error.
fn unit([sin, cos]: [f32; 2]) -> [f32; 2] {
    let gain = 1.5 - 0.5 * (sin * sin + cos * cos);
    [gain * sin, gain * cos]
}
