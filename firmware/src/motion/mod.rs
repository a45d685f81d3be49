//! The motion itself, apart from any frame of it: settings, stepping, planning.

mod misprinted;
mod planner;
mod settings;
mod simulation;

pub use misprinted::Misprinted;
pub use planner::{Finding, Planned, Planner, Viewport, half_pixel, problem};
pub use settings::Settings;
pub use simulation::{CatchingUp, Energy, Means, Simulation};
