//! The map of flips in vectors. The kernel's search is inlined into its caller: in a package of its own it is compiled with full
//! optimisation in every profile, while the commands around it compile fast.

use double_pendulum::flips::{Flip, Flips};
use double_pendulum::{DirectionF32Plain, Error};
use multiversion::multiversion;

/// The kernel's search with the cheapest steps.
pub type Search = Flips<DirectionF32Plain>;

/// Numbers in a row: a vector of 8 with AVX2, two of 4 without.
const LANES: usize = 8;

/// The flips of some starts, by the widest vectors that this processor has.
#[multiversion(targets("x86_64+avx2+bmi1+bmi2+fma+lzcnt+popcnt"))]
pub fn flips(search: &Search, starts: &[[f32; 2]]) -> Result<Vec<Flip<f32>>, Error> {
    each(search, starts)
}

/// The same for any processor of this kind, without a look at what this one has.
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
