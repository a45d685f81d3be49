//! Tests of the kernel: compared with the reference, with closed forms and with its own symmetries.

mod bounds;
mod closed_form;
mod day;
mod divergence;
mod fixed;
mod flips;
mod forms;
mod golden;
mod hard_cases;
mod known_answers;
mod limits;
mod methods;
mod plan;
mod plan_study;
mod range;
mod small_oscillations;
#[path = "../support/snapshot.rs"]
mod snapshot;
mod stated_errors;
