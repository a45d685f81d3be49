//! The pendulum and its equations of motion, each as the book has it.

pub(crate) mod directions;
mod geometry;
pub(crate) mod hamiltonian;
mod lagrangian;
mod parameters;
mod state;

pub use directions::Direction;
pub use geometry::Vector;
pub use hamiltonian::Pendulum;
pub use parameters::Parameters;
pub use state::{Motion, State};
