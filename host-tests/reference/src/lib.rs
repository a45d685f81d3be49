//! The exact motion, which everything is held against, by two roads that have nothing in common but the book: a set that it is proved
//! to be in, and, many times faster, about 30 digits of it.

#![forbid(unsafe_code)]

pub mod enclosure;
pub mod taylor;

pub use twofloat;

use double_pendulum::flips::{Flip, Flips};
use double_pendulum::parts::DirectionF64;
use double_pendulum::{Error, Run};

/// Advances RK4 in compensated `f64`, beside which RK4 in fewer bits is tested for as long as a day: from here it is optimised.
pub fn advance(run: &mut Run<DirectionF64>, steps: u32) -> Result<(), Error> {
    run.advance(steps)
}

/// When a rod first turns over, by the same method: the map of flips is judged by it.
pub fn flip(search: &Flips<DirectionF64>, a1: f64, a2: f64) -> Result<Flip<f64>, Error> {
    search.of(a1, a2)
}
