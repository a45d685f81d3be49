//! The exact motion, the standard of comparison for all methods. It is computed in two ways that
//! have only the book's equations in common: a set that is proved to contain the motion, and, many
//! times faster, about 30 digits of the motion.
//!
//! With it are the motions and tolerances that several tests share. [`optimised`] and [`vectors`]
//! are here because this package is optimised in every profile.

pub mod enclosure;
pub mod hard_cases;
pub mod known_answers;
pub mod optimised;
#[path = "../../../kernel/src/tests/random.rs"]
pub mod random;
pub mod taylor;
pub mod textbook;
pub mod tolerances;
pub mod trials;
pub mod vectors;

pub use twofloat;

use double_pendulum::flips::{Flip, Flips};
use double_pendulum::parts::DirectionF64;
use double_pendulum::{Error, Run};

/// Advances RK4 in compensated `f64`, with a count of turns. Tests compare RK4 in fewer bits with
/// it for as long as a day.
pub fn advance(run: &mut Run<DirectionF64, true>, steps: u32) -> Result<(), Error> {
    run.advance(steps)
}

/// Returns the time when a rod first turns over, by RK4 in compensated `f64`. The map of flips is
/// compared with it.
pub fn flip(search: &Flips<DirectionF64>, a1: f64, a2: f64) -> Result<Flip<f64>, Error> {
    search.of(a1, a2)
}
