//! Sums and products of floating-point numbers by integer arithmetic, for processors without a floating-point unit.
//!
//! IEEE 754, round to nearest, ties to even: to the bit what a processor with such a unit gives (test `soft_float`), of any
//! numbers, subnormal ones and infinities too; only which NaN comes out is not the same everywhere. A number is its bits,
//! `u32` or `u64`. The compiler calls these functions by the names that `board/cortex_m/soft_float.rs` gives them.
//!
//! Two finite numbers with leading 1 whose result has one too go the short way, here: on a Cortex-M3 55 cycles for a sum
//! and 49 for a product of `f32`, 104 and 99 of `f64` (estimates; `cargo count --listing`). All else is left to `rare`.

mod rare;
mod word;

pub use word::Word;

/// a + b.
#[inline(always)]
pub fn add<W: Word>(a: W, b: W) -> W {
    let (a, b) = if magnitude(a) < magnitude(b) { (b, a) } else { (a, b) };
    let (exponent, lesser) = (exponent(a), exponent(b));
    if lesser == 0 || exponent == W::SPECIAL {
        return rare::add(a, b);
    }
    let distance = exponent - lesser;
    if distance > W::FRACTION + 2 {
        return a;
    }
    // One bit is left for the carry.
    let (large, small) = (significand(a) >> 1, (significand(b) >> 1).jammed(distance));
    let sum = if (a ^ b) & W::SIGN == W::ZERO { large.wrapping_add(small) } else { large.wrapping_sub(small) };
    if sum == W::ZERO {
        return W::ZERO;
    }
    let (zeros, significand) = sum.normalised();
    nearest(a & W::SIGN, (exponent + 1).wrapping_sub(zeros), significand)
}

/// -b.
#[inline(always)]
pub fn negative<W: Word>(b: W) -> W {
    b ^ W::SIGN
}

/// a b.
#[inline(always)]
pub fn multiply<W: Word>(a: W, b: W) -> W {
    let (first, second) = (exponent(a), exponent(b));
    if !is_finite::<W>(first) || !is_finite::<W>(second) {
        return rare::multiply(a, b);
    }
    // Between 1 and 4: the leading 1 is in the topmost bit or the next.
    let product = significand(a).high_product(significand(b));
    let carried = product >> (W::FRACTION + W::SPARE);
    let doubled = product & carried.wrapping_sub(W::ONE); // nothing if it is carried
    let exponent = (first + second + carried.low()).wrapping_sub(W::BIAS);
    nearest((a ^ b) & W::SIGN, exponent, product.wrapping_add(doubled))
}

/// The number of this sign and exponent nearest to a significand whose leading 1 is in the topmost bit.
#[inline(always)]
fn nearest<W: Word>(sign: W, exponent: u32, significand: W) -> W {
    if exponent.wrapping_sub(1) >= W::SPECIAL - 2 {
        return rare::nearest(sign, exponent as i32, significand);
    }
    let kept = significand >> W::SPARE;
    let half = (significand >> (W::SPARE - 1)) & W::ONE;
    // Rounded up to the next power of two it carries into the exponent, as it should.
    let nearest = (sign | (W::from(exponent - 1) << W::FRACTION)).wrapping_add(kept).wrapping_add(half);
    let is_tie = significand << (W::FRACTION + 1) == W::SIGN;
    if is_tie { nearest & !W::ONE } else { nearest }
}

/// The bits without the sign's, in their order.
#[inline(always)]
fn magnitude<W: Word>(a: W) -> W {
    a & !W::SIGN
}

#[inline(always)]
fn exponent<W: Word>(a: W) -> u32 {
    (a >> W::FRACTION).low() & W::SPECIAL
}

/// The fraction after its leading 1, which is in the topmost bit.
#[inline(always)]
fn significand<W: Word>(a: W) -> W {
    a << W::SPARE | W::SIGN
}

/// Whether this is the exponent of a finite number with a leading 1.
#[inline(always)]
fn is_finite<W: Word>(exponent: u32) -> bool {
    exponent.wrapping_sub(1) < W::SPECIAL - 1
}
