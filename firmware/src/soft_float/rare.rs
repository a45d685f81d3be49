//! All numbers, as the standard has them: zeros, subnormal numbers, infinities, NaN, and results that become such.

use super::{Word, exponent, magnitude};

/// A finite number but 0: its significand, the leading 1 in the topmost bit, and the exponent it would be stored with if
/// exponents had no ends.
struct Finite<W> {
    exponent: i32,
    significand: W,
}

/// a + b.
#[cold]
#[inline(never)]
pub fn add<W: Word>(a: W, b: W) -> W {
    // The greater magnitude first; NaN is greater than all, infinity than all else.
    let (a, b) = if magnitude(a) < magnitude(b) { (b, a) } else { (a, b) };
    if is_nan(a) || is_infinite(a) && b == a ^ W::SIGN {
        return nan();
    }
    if is_infinite(a) || is_zero(b) && !is_zero(a) {
        return a;
    }
    if is_zero(b) {
        return a & b;
    }
    let (sign, is_sum) = (a & W::SIGN, (a ^ b) & W::SIGN == W::ZERO);
    let (a, b) = (finite(a), finite(b));
    let (large, small) = (a.significand >> 1, jammed(b.significand >> 1, a.exponent.abs_diff(b.exponent)));
    let sum = if is_sum { large.wrapping_add(small) } else { large.wrapping_sub(small) };
    if sum == W::ZERO {
        return W::ZERO;
    }
    let (zeros, significand) = sum.normalised();
    super::nearest(sign, (a.exponent + 1).wrapping_sub_unsigned(zeros) as u32, significand)
}

/// a b.
#[cold]
#[inline(never)]
pub fn multiply<W: Word>(a: W, b: W) -> W {
    let sign = (a ^ b) & W::SIGN;
    let is = |one: fn(W) -> bool| one(a) || one(b);
    if is(is_nan) || is(is_infinite) && is(is_zero) {
        return nan();
    }
    if is(is_infinite) {
        return sign | infinity();
    }
    if is(is_zero) {
        return sign;
    }
    let (a, b) = (finite(a), finite(b));
    let (zeros, significand) = a.significand.high_product(b.significand).normalised();
    let exponent = a.exponent + b.exponent + 1 - W::BIAS as i32;
    super::nearest(sign, exponent.wrapping_sub_unsigned(zeros) as u32, significand)
}

/// The number nearest to a significand whose leading 1 is in the topmost bit, of an exponent at or beyond its ends.
#[cold]
#[inline(never)]
pub fn nearest<W: Word>(sign: W, exponent: i32, significand: W) -> W {
    if exponent >= W::SPECIAL as i32 {
        return sign | infinity();
    }
    // Below the least exponent the leading 1 moves down. One that is still there adds 1 to the exponent stored.
    let (stored, significand) =
        if exponent > 0 { (exponent as u32 - 1, significand) } else { (0, jammed(significand, exponent.abs_diff(1))) };
    let (kept, rest) = (significand >> W::SPARE, significand << (W::FRACTION + 1));
    let is_up = rest > W::SIGN || rest == W::SIGN && kept & W::ONE == W::ONE;
    (sign | W::from(stored) << W::FRACTION).wrapping_add(kept).wrapping_add(if is_up { W::ONE } else { W::ZERO })
}

fn infinity<W: Word>() -> W {
    W::from(W::SPECIAL) << W::FRACTION
}

fn nan<W: Word>() -> W {
    infinity::<W>() | W::ONE << (W::FRACTION - 1)
}

fn is_zero<W: Word>(a: W) -> bool {
    magnitude(a) == W::ZERO
}

fn is_infinite<W: Word>(a: W) -> bool {
    magnitude(a) == magnitude(infinity::<W>())
}

fn is_nan<W: Word>(a: W) -> bool {
    magnitude(a) > magnitude(infinity::<W>())
}

fn finite<W: Word>(a: W) -> Finite<W> {
    let stored = exponent(a);
    // A subnormal number has the least exponent, and no leading 1 in its place.
    let leading = if stored == 0 { W::ZERO } else { W::SIGN };
    let (zeros, significand) = (a << W::SPARE & !W::SIGN | leading).normalised();
    Finite { exponent: (stored.max(1) as i32).wrapping_sub_unsigned(zeros), significand }
}

/// [`Word::jammed`] by any number of places.
fn jammed<W: Word>(significand: W, places: u32) -> W {
    if places > W::FRACTION + W::SPARE { W::ONE } else { significand.jammed(places) }
}
