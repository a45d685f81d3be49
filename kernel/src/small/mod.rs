//! Small oscillations: the normal modes, and the motion they make in closed form.

mod closed_form;
mod modes;

pub use closed_form::{Oscillation, SmallOscillations};
pub use modes::{Mode, Modes, periodic_mass_ratio};
