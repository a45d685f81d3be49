//! The planar double pendulum: Hamilton's equations, stepped by the classical Runge-Kutta method.
//!
//! Bob 1 hangs on rod 1 from a fixed pivot, bob 2 on rod 2 from bob 1; rods are rigid and massless, pivots frictionless.
//! Angles are measured from the downward vertical, counter-clockwise positive; y points up; SI units throughout.
//!
//! | the book says | here | the test that fails when it is wrong |
//! |---|---|---|
//! | Lagrange's equations | [`Pendulum::lagrangian`], [`Pendulum::accelerations`] | `tests::lagrange` |
//! | Legendre transformation | [`Pendulum::to_state`], [`Pendulum::to_motion`] | `tests::lagrange` |
//! | Hamilton's equations, H | [`Pendulum::derivatives`], [`Pendulum::energy`]; equal rods: [`Parameters::equal_rods`] | `tests::hamilton` |
//! | Runge-Kutta method | [`Pendulum::step`], [`rk4::step`] | `tests::added_method`; host: `methods` |
//! | small oscillations | [`Modes`], [`SmallOscillations`] | `tests::small_oscillations` |
//! | coordinates | [`Pendulum::positions`], [`Pendulum::velocities`] | `tests::lagrange` |
//! | (not in the book) bounds from the energy | [`Bounds`], [`Pendulum::cannot_turn_over`], [`Pendulum::admissible_step`], [`Modes::step_limit`] | host: `bounds`, `limits` |
//! | (not in the book) when a rod first turns over | [`flips`] | host: `flips` |
//! | (not in the book) every way to compute a motion | [`Method`]; [`Pendulum::run`] with [`HamiltonF64`], [`DirectionF32`], [`Fixed32`], [`Fixed64`], [`ExtrapolationF64`], [`ClosedFormF32`] | host: `known_answers`, `hard_cases`, `methods` |
//! | (not in the book) the cheapest method that keeps to a tolerance | [`plan`](mod@plan) | host: `plan`, `plan_study` |
//!
//! Tests of this crate, and of the repository's host-tests (`--test kernel`).
//!
//! The equations are generic over `f32` and `f64` ([`Real`]); methods compute in these or in fixed point. No heap, no panics,
//! and the same bits on every machine.
//!
//! A motion is a [`Run`] of a pendulum by one method; only that method is linked:
//!
//! ```
//! use double_pendulum::{DirectionF32, Parameters, Pendulum, State};
//!
//! let pendulum = Pendulum::new(&Parameters { m1: 1.0, m2: 2.0, l1: 1.0, l2: 0.5, g: 9.81 })?;
//! let mut run = pendulum.run::<DirectionF32>(&State::at_rest(0.5, 1.0), 1.0 / 240.0)?;
//! run.advance(240)?; // all or nothing: a motion that leaves the finite numbers is an error
//! let [[_sin1, _cos1], [_sin2, _cos2]] = run.directions(); // enough to draw both rods
//! let [a1, a2] = run.angles(); // with all their turns
//! assert!(a1.abs() < 1.0 && a2.abs() < 3.0 && run.time() == 1.0);
//! assert!((f64::from(run.energy()) - pendulum.energy(&run.state())).abs() < 1e-4);
//! # Ok::<(), double_pendulum::Error>(())
//! ```
//!
//! Accuracy figures here and below are asserted by the tests of the repository.
//!
//! # Versions
//!
//! Semantic versioning. [`Error`] and [`Parameter`] may get new variants, and the traits are sealed,
//! so that they may get new methods; both are minor versions, as is a higher least Rust (1.85 now). What is hidden from the
//! documentation may change at any time.
//!
//! A change of any bit of a step is a major version. Steps use IEEE 754 arithmetic alone (and `sqrt` and `rint`, which are
//! correctly rounded) for angles up to 12,867 rad in `f32` and 1,647,098 rad in `f64`. The sines of larger ones and the
//! `atan2` in [`Run::state`] are those of the `libm` crate that your lock file names (0.2.16 or later): to compare
//! machines, build both with the same.
//!
//! # References
//!
//! - `[math24]` "Double Pendulum", math24.net, 23 August 2021: the book of this crate. Three of its formulas are
//!   misprinted and corrected here: p2's second term ([`Pendulum::to_state`]), the sign of the quadratic Lagrangian's last
//!   term, and the equal-rod form's second equation, which lacks the factor mu in its denominator.
//! - `[Landau]` L. D. Landau, E. M. Lifshitz, *Mechanics*, 3rd ed., Pergamon 1976.
//! - `[Hairer I]` E. Hairer, S. P. Norsett, G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed.,
//!   Springer 1993.
//! - `[Hairer II]` E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., Springer 1996.
#![no_std]
#![forbid(unsafe_code)]
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
    Fixed64, Form, HamiltonF32, HamiltonF64, Oscillation, Run, SmallOscillations, rk4,
};
pub use numbers::Real;
pub use pendulum::{Direction, Motion, Parameters, Pendulum, State, Vector};
pub use small::{Mode, Modes, periodic_mass_ratio};
pub use table::{Equations, Integrator, Method, Numbers};

/// What the methods are made of, for tools and tests; it may change at any time.
#[doc(hidden)]
pub mod parts {
    pub use crate::methods::{Canonical, Derivatives, DirectionF64, Rk4Direction, Turns};
}

/// The README's examples, as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
