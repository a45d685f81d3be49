//! What a step may cost: one row for each goal, with its reason.

use double_pendulum::Parameters;
use firmware::job::Arithmetic::{F32, F32Compensated, F64};
use firmware::job::Formulation::{Angle, Direction, DirectionDivided};
use firmware::job::{Arithmetic, Formulation, Row};

/// The most cycles (estimated) that a step of an arithmetic may take on a core.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// The arithmetic.
    pub row: Row,
    /// QEMU's name of the core.
    pub cpu: &'static str,
    /// The length of rod 2, m; that of rod 1 is 1.
    pub l2: f64,
    /// Estimated cycles.
    pub cycles: f64,
    /// Where the number comes from.
    pub reason: &'static str,
}

const M3: &str = "cortex-m3";
const M4F: &str = "cortex-m4";

#[rustfmt::skip]
const fn goal(arithmetic: Arithmetic, form: Formulation, cpu: &'static str, l2: f64, cycles: f64, reason: &'static str) -> Goal {
    Goal { row: Row::rk4(arithmetic, form), cpu, l2, cycles, reason }
}

/// Every goal, for steps of 1/256 s from rest at 0.5 rad, masses alike.
#[rustfmt::skip]
pub const GOALS: &[Goal] = &[
    goal(F32Compensated, Angle,     M4F, 1.0, 370.0,    "the trial's 387, which had no guard"),
    goal(F32Compensated, Angle,     M4F, 0.5, 410.0,    "10 % more for rods of any lengths"),
    goal(F32Compensated, Direction, M4F, 1.0, 220.0,    "the trial's 271"),
    goal(F32,            Direction, M4F, 1.0, 170.0,    "the trial's 198; no division"),
    goal(F64,            Angle,     M4F, 1.0, 31_000.0, "in software; 40,000 was asked, the trial's 57,500 had own sines on the angles"),
    goal(F64,            Direction, M4F, 1.0, 17_500.0, "cheaper still without angles"),
    goal(F32,            DirectionDivided, M3, 1.0, 9_200.0, "in software; 12,000 was asked. 70 additions of 55 cycles, 62 products of 49, 4 quotients of 117, and 1,000 of its own"),
];

impl Goal {
    /// The pendulum that is counted.
    pub fn parameters(&self) -> Parameters<f64> {
        Parameters { m1: 1.0, m2: 1.0, l1: 1.0, l2: self.l2, g: 9.81 }
    }
}
