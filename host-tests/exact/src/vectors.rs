//! The map of flips, computed with vector instructions.
//!
//! The kernel's search is inlined into its caller. It is in this package so that it is compiled with
//! full optimisation in every profile, while the commands compile fast.

use double_pendulum::flips::{Flip, Flips};
use double_pendulum::{DirectionF32Plain, Error};
use multiversion::multiversion;

/// The kernel's search with the method whose steps cost least, the direction form in plain `f32`.
/// Angles are in rad, times in s. [`Flips::new`] creates it.
pub type Search = Flips<DirectionF32Plain>;

/// The number of starts that are computed side by side: a vector of 8 with AVX2, two vectors of 4
/// without.
const LANES: usize = 8;

/// Returns the first flip from rest at each of the starts (a1, a2 in rad), bit-identical to
/// [`Flips::of`], with AVX2 if the processor has it.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+fma+lzcnt+popcnt"))]
pub fn flips(search: &Search, starts: &[[f32; 2]]) -> Result<Vec<Flip<f32>>, Error> {
    each(search, starts)
}

/// Returns the same as [`flips`] with instructions that every processor of this architecture has.
pub fn baseline(search: &Search, starts: &[[f32; 2]]) -> Result<Vec<Flip<f32>>, Error> {
    each(search, starts)
}

#[inline(always)]
fn each(search: &Search, starts: &[[f32; 2]]) -> Result<Vec<Flip<f32>>, Error> {
    let mut flips = vec![Flip::Never; starts.len()];
    search.of_each::<LANES>(starts.iter().copied(), |start, flip| {
        if let Some(place) = flips.get_mut(start) {
            *place = flip;
        }
    })?;
    Ok(flips)
}
