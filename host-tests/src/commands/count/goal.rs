//! What a step may cost: one row for each goal, with its reason.

use double_pendulum::{Method, Parameters};

/// The most cycles (estimated) that a step of a method may take on a core.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// The method.
    pub method: Method,
    /// QEMU's name of the core.
    pub cpu: &'static str,
    /// The mass of bob 2, kg, and the length of rod 2, m; those of bob 1 and rod 1 are 1.
    pub second: [f64; 2],
    /// Estimated cycles.
    pub cycles: f64,
    /// Where the number comes from.
    pub reason: &'static str,
}

const M3: &str = "cortex-m3";
const M4F: &str = "cortex-m4";

const fn goal(method: Method, cpu: &'static str, second: [f64; 2], cycles: f64, reason: &'static str) -> Goal {
    Goal { method, cpu, second, cycles, reason }
}

/// As the first.
const ALIKE: [f64; 2] = [1.0, 1.0];

/// Every goal, for steps of 1/256 s from rest at 0.5 rad.
#[rustfmt::skip]
pub const GOALS: &[Goal] = &[
    goal(Method::Rk4F32Direction, M4F, ALIKE, 220.0,    "202 counted"),
    goal(Method::Rk4F32DirectionPlain, M4F, ALIKE, 170.0,    "159 counted; no division"),
    goal(Method::Rk4F64Direction, M4F, ALIKE, 21_000.0, "20,496 counted; in software"),
    goal(Method::Rk4Fixed32, M3, ALIKE, 675.0, "668 counted"),
    goal(Method::Rk4Fixed32, M3, [2.0, 0.5], 870.0, "a quarter more for shifts of each quantity"),
];

/// What a simulated second may cost, in the steps that keep an error.
#[derive(Clone, Copy, Debug)]
pub struct SecondGoal {
    /// The index of the scene in the report's.
    pub scene: usize,
    /// The largest error over the scene, rad.
    pub error: f64,
    /// QEMU's name of the core.
    pub cpu: &'static str,
    /// Estimated cycles.
    pub cycles: f64,
    /// Where the number comes from.
    pub reason: &'static str,
}

#[rustfmt::skip]
const fn second(scene: usize, error: f64, cpu: &'static str, cycles: f64, reason: &'static str) -> SecondGoal {
    SecondGoal { scene, error, cpu, cycles, reason }
}

/// In 64 bits of fixed point, by the order and the number of steps through the scene that make it cheapest.
#[rustfmt::skip]
pub const SECONDS: &[SecondGoal] = &[
    second(0, 1e-9,    M4F, 120_000.0, "62 steps in 10 s: seven a second, the fewest whole ones, come to 131,000"),
    second(0, 1e-12,   M4F, 210_000.0, "order 16 is cheaper than 12"),
    second(0, 1e-12,   M3,  300_000.0, "likewise"),
    second(1, 3.5e-10, M4F, 750_000.0, "chaotic"),
];

impl Goal {
    /// The pendulum that is counted.
    pub fn parameters(&self) -> Parameters<f64> {
        let [m2, l2] = self.second;
        Parameters { m1: 1.0, m2, l1: 1.0, l2, g: 9.81 }
    }
}
