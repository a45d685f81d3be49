//! The exact motion, the standard of comparison for all methods. It is computed in two ways that
//! have only the book's equations in common: a set that is proved to contain the motion, and, many
//! times faster, about 30 digits of the motion.

#![forbid(unsafe_code)]

pub mod enclosure;
pub mod optimised;
pub mod taylor;

pub use twofloat;

use double_pendulum::flips::{Flip, Flips};
use double_pendulum::parts::DirectionF64;
use double_pendulum::{Error, Run};

/// Advances RK4 in compensated `f64`, with a count of turns. Tests compare RK4 in fewer bits with
/// it for as long as a day. 0 steps change nothing. This function is in this package because the
/// package is optimised in every profile.
///
/// An [`Error::Diverged`] means that the motion has diverged by the checks of [`Run::advance`],
/// made once at the end: numbers that are not finite, directions shorter than 1/2 or longer than 2,
/// or an energy far above the initial one. `run` is then unchanged.
pub fn advance(run: &mut Run<DirectionF64, true>, steps: u32) -> Result<(), Error> {
    run.advance(steps)
}

/// Returns [`Flip::After`] the time when a rod first turns over, s, by RK4 in compensated `f64`:
/// when it passes straight up, interpolated within a step. The map of flips is compared with it.
/// The start is at rest at `a1` and `a2`, rad. The time is negative if the steps of `search` are.
/// The result is [`Flip::Never`] if the energy is too low, and [`Flip::Later`] if no rod turns over
/// within the steps of `search`. Angles that are not finite are an error. Not checked: that the
/// motion does not diverge ([`Flips`]).
pub fn flip(search: &Flips<DirectionF64>, a1: f64, a2: f64) -> Result<Flip<f64>, Error> {
    search.of(a1, a2)
}
