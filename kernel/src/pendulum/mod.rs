//! The pendulum and its equations of motion, each as the book has it.

pub(crate) mod directions;
mod hamiltonian;
mod inputs;
mod lagrangian;

pub use directions::Direction;
pub use hamiltonian::Pendulum;
pub use inputs::{Motion, Parameters, State};
pub use lagrangian::Vector;
