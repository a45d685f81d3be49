//! A motion as frames need it: the directions of both rods, in the kernel's direction form.

use double_pendulum::form::{Direction, DirectionForm, Stepper};

/// The directions of both rods, (sin, cos) each.
pub type Directions = [Direction<f32>; 2];

/// A pendulum in motion, in `f32` whose additions lose nothing.
pub type DirectionStepper = Stepper<f32, DirectionForm<f32>>;
