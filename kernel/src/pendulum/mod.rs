//! The pendulum and its equations of motion, each as the book has it.

mod hamiltonian;
mod inputs;
mod lagrangian;

pub use hamiltonian::Pendulum;
pub use inputs::{Motion, Parameters, State};
pub use lagrangian::Vector;

/// (sin, cos) of an angle from the downward vertical.
pub type Direction<R> = [R; 2];
