//! What goes in and out of a program can be kept with `serde` and logged with `defmt`.
#![cfg(all(feature = "serde", feature = "defmt"))]

use double_pendulum::Method;
use double_pendulum::plan::{Budget, Costs, Limit, Plan, PlanError, Problem, Way};
use double_pendulum::{Error, Motion, Parameter, Parameters, State};

/// The compiler refuses a type that lacks a trait.
fn is_kept_and_logged<T: Copy + PartialEq + serde::Serialize + serde::de::DeserializeOwned + defmt::Format>() {}

#[test]
fn inputs_and_results_are_kept_and_logged() {
    is_kept_and_logged::<(Parameters<f32>, State<f64>, Motion<f32>)>();
    is_kept_and_logged::<(Error, Parameter, PlanError)>();
    is_kept_and_logged::<(Problem, Costs, Budget, Method, Way, Limit, Plan)>();
}
