//! The pendulum and its equations of motion, as in `[math24]`.

mod hamiltonian;
mod lagrangian;
mod parameters;
mod state;

pub use hamiltonian::Pendulum;
pub use lagrangian::Vector;
pub use parameters::Parameters;
pub use state::{Motion, State};

/// `[sin, cos]` of an angle from the downward vertical. Its length is 1, except for the errors of
/// the method that computed it. Only in [`Run::directions_q30`](crate::Run::directions_q30) both
/// numbers are integers, in multiples of 2^-30.
pub type Direction<R> = [R; 2];
