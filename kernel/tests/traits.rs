//! The inputs and results of a program can be stored with `serde` and logged with `defmt`.
#![cfg(all(feature = "serde", feature = "defmt"))]

use double_pendulum::plan::{Plan, PlanError};
use double_pendulum::{Error, Parameters, State};

/// The compiler refuses a type that lacks a trait.
fn is_kept_and_logged<
    T: Copy + PartialEq + serde::Serialize + serde::de::DeserializeOwned + defmt::Format,
>() {
}

#[test]
fn inputs_and_results_are_kept_and_logged() {
    is_kept_and_logged::<(Parameters<f32>, State<f64>, Error, PlanError, Plan)>();
}
