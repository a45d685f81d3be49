//! The motion, independent of its picture: settings, method and step count, planning.

mod horizon;
mod misprinted;
mod planner;
mod settings;
mod simulation;

pub use horizon::Horizon;
pub use misprinted::Misprinted;
pub use planner::{PlanResult, Planned, Planner};
pub use settings::{Settings, half_pixel};
pub use simulation::{CatchingUp, Energy, Resources, Simulation};
