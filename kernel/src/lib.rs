//! The planar double pendulum: its equations, and fast and exact ways to compute its motion.
//!
//! Bob 1 hangs on rod 1 from a fixed pivot, bob 2 on rod 2 from bob 1. The rods are rigid and have
//! no mass; the pivots have no friction. Angles are measured from the downward vertical, positive
//! counter-clockwise. The y axis points up. All units are SI units.
//!
//! The equations are generic over `f32` and `f64` ([`Real`]). The methods compute in these or in
//! fixed point. The crate needs no heap, does not panic, and gives the same bits on every machine.
//!
//! # Example
//!
//! A motion is a [`Run`] of a pendulum by one method. Only that method is linked.
//!
//! ```
//! use double_pendulum::{DirectionF32, Parameters, Pendulum, State};
//!
//! let pendulum = Pendulum::new(&Parameters { m1: 1.0, m2: 2.0, l1: 1.0, l2: 0.5, g: 9.81 })?;
//! let mut run = pendulum.run::<DirectionF32>(&State::at_rest(0.5, 1.0), 1.0 / 240.0)?;
//! run.advance(240)?; // All or nothing: a motion that leaves the finite numbers is an error.
//! let [[_sin1, _cos1], [_sin2, _cos2]] = run.directions(); // Enough to draw both rods.
//! let [a1, a2] = run.angles(); // Within half a turn; `Run::counting_turns` counts the others.
//! assert!(a1.abs() < 1.0 && a2.abs() < 3.0 && run.time() == 1.0);
//! assert!((f64::from(run.energy()) - pendulum.energy(&run.state())).abs() < 1e-4);
//! # Ok::<(), double_pendulum::Error>(())
//! ```
//!
//! # From the book to the code
//!
//! The book is `[math24]`, see below. The last column names the test that fails if the item is
//! wrong: a module of this crate's tests or, after "host", of the repository's `--test kernel`.
//!
//! | in the book | here | test |
//! |---|---|---|
//! | Lagrange's equations | [`Pendulum::lagrangian`], [`Pendulum::accelerations`] | `lagrange` |
//! | Legendre transformation | [`Pendulum::to_state`], [`Pendulum::to_motion`] | `lagrange` |
//! | Hamilton's equations, H | [`Pendulum::derivatives`], [`Pendulum::energy`] | `hamilton` |
//! | equal rods | [`Parameters::equal_rods`] | `hamilton` |
//! | Runge-Kutta method | [`rk4::step`]; drawn: [`Fixed32`], [`DirectionF32`] | `integrators` |
//! | small oscillations | [`Modes`], [`SmallOscillations`] | `small_oscillations` |
//! | coordinates | [`Pendulum::positions`], [`Pendulum::velocities`] | `lagrange` |
//!
//! | not in the book | here | test |
//! |---|---|---|
//! | bounds from the energy | [`Bounds`], [`Pendulum::cannot_turn_over`] | host: `bounds` |
//! | step sizes | [`Pendulum::admissible_step`], [`Modes::step_limit`] | host: `limits` |
//! | the time of the first flip | [`flips`] | host: `flips` |
//! | all methods | [`Method::visit`], [`Pendulum::run`] | host: `known_answers`, `hard_cases` |
//! | the cheapest accurate method | [`plan`](mod@plan) | host: `plan`, `plan_study` |
//!
//! # Glossary
//!
//! Physics:
//!
//! - **canonical momentum**: p1, p2, conjugate to the angles a1, a2; the numbers of a [`State`].
//! - **motion**: angles and angular velocities ([`Motion`]), or the course of a pendulum in time.
//! - **energy above rest**: the energy H above that of hanging at rest, K = H - min V.
//! - **normal mode**: an oscillation with a fixed ratio of the angles; there are two ([`Modes`]).
//! - **flip**: a rod turns over, when its angle passes plus or minus pi.
//! - **elbow**: the joint between the rods; its angle is D = a1 - a2.
//! - **den**: m1 + m2 sin^2 D, the denominator of the equations.
//! - **regular, chaotic**: a motion whose errors grow slowly, or exponentially.
//!
//! Numerics:
//!
//! - **method**: equations, numbers and an integrator: a row of the table [`Method`].
//! - **form**: a type that implements a method; the argument of [`Pendulum::run`].
//! - **direction**: (sin, cos) of an angle.
//! - **direction form**: Hamilton's equations with directions instead of angles.
//! - **closed form**: the solution of the linear equations at any time, without steps.
//! - **compensated**: the rounding error of each sum is carried into the next.
//! - **unit of time**: a method's own unit, chosen so that its numbers are in range.
//! - **admissible step**: the longest step that resolves every motion of an energy.
//! - **diverged, lost**: a motion that has left the finite numbers or the range of its method.
//! - **golden bits**: the bits of every method, stored in `golden/bits.csv`.
//!
//! Plans:
//!
//! - **scene**: a pendulum and its start, which an application shows.
//! - **frame**: a picture of the motion, at a fixed rate.
//! - **tolerance**: the largest allowed distance of a bob from its exact position.
//! - **accurate**: within the tolerance of the exact motion.
//! - **accuracy horizon**: the time until which all frames are accurate.
//! - **stepping**: a method and its number of steps per frame.
//! - **price list**: the cost of a step by each method, usually in cycles.
//! - **budget**: the largest cost of a frame, or of planning.
//!
//! # Versions
//!
//! Semantic versioning. [`Error`], [`Parameter`], [`plan::PlanError`] and [`plan::Limit`] may get
//! new variants, [`plan::Costs`] new prices, and the traits [`Real`] and [`Form`] are sealed and may
//! get new methods; all are minor versions, as is a higher least Rust version (1.85 now). Items that are hidden from the
//! documentation may change at any time.
//!
//! A change of any bit of a step is a major version. "Determinism scope" in the README says which
//! results also depend on the version of `libm`. The steps use only IEEE 754 arithmetic, and the
//! correctly rounded `sqrt` and `rint`.
//!
//! # References
//!
//! - `[math24]` "Double Pendulum", math24.net, 23 August 2021: the book of this crate. Three of its
//!   formulas are misprinted and corrected here: the second term of p2 ([`Pendulum::to_state`]),
//!   the sign of the last term of the quadratic Lagrangian, and the second equation of equal rods,
//!   whose denominator lacks the factor mu.
//! - `[Landau]` L. D. Landau, E. M. Lifshitz, *Mechanics*, 3rd ed., Pergamon 1976.
//! - `[Hairer I]` E. Hairer, S. P. Norsett, G. Wanner, *Solving Ordinary Differential Equations I*,
//!   2nd ed., Springer 1993.
//! - `[Hairer II]` E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed.,
//!   Springer 1996.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![warn(missing_copy_implementations, missing_debug_implementations)]
#![warn(clippy::must_use_candidate, clippy::return_self_not_must_use)]

// The tests call the kernel by its name, as its users do.
#[cfg(test)]
extern crate self as double_pendulum;
#[cfg(test)]
extern crate std;

mod bounds;
mod error;
pub mod flips;
#[doc(hidden)] // For emulated cores and boards, which compute the golden bits, too.
pub mod golden;
mod methods;
mod numbers;
mod pendulum;
pub mod plan;
mod small;
mod table;
#[cfg(test)]
mod tests;

pub use bounds::Bounds;
pub use error::{Error, Parameter};
pub use methods::extrapolation::Extrapolation;
pub use methods::{
    ClosedFormF32, ClosedFormF64, DirectionF32, DirectionF32Plain, ExtrapolationF64, Fixed32,
    Fixed64, Form, FormVisitor, HamiltonF32, HamiltonF64, Run, SmallOscillations, rk4,
};
pub use numbers::{Real, radians, sin_cos};
pub use pendulum::{Direction, Motion, Parameters, Pendulum, State, Vector};
pub use small::{Mode, Modes, periodic_mass_ratio};
pub use table::{Equations, Integrator, Method, Numbers};

/// Parts of the methods, for the firmware, tools and tests. They may change at any time.
#[doc(hidden)] // Needed by one of these each, not by a user who computes a motion.
pub mod parts {
    pub use crate::flips::falling::Falling;
    pub use crate::methods::any::{advance, start};
    pub use crate::methods::{
        Advance, Canonical, Derivatives, DirectionF64, Rk4, Rk4Direction, RungeKutta, Turns,
    };
}

/// The examples of the README, as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
