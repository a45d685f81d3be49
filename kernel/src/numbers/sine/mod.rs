//! The kernel's own sines and cosines: the argument less a multiple of pi/2 (Cody-Waite reduction), then minimax polynomials.

pub mod own_f32;
pub mod own_f64;

use core::ops::Neg;

/// The direction (sin, cos) turned by `quarters` quarter turns; only the two lowest bits of `quarters` count.
#[inline]
pub(crate) fn by_quarters<R: Copy + Neg<Output = R>>((sine, cosine): (R, R), quarters: u32) -> (R, R) {
    let (sine, cosine) = if quarters & 1 == 0 { (sine, cosine) } else { (cosine, -sine) };
    if quarters & 2 == 0 { (sine, cosine) } else { (-sine, -cosine) }
}
