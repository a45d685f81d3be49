//! The bits of `f32` and `f64`.

use core::ops::{BitAnd, BitOr, BitXor, Not, Shl, Shr};

/// The bits of a floating-point number: sign, exponent, fraction.
pub trait Word:
    Copy
    + PartialOrd
    + From<u32>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// The topmost bit.
    const SIGN: Self;
    /// Bits of the fraction.
    const FRACTION: u32;
    /// The bits that sign and exponent leave to a significand: all but one of theirs.
    const SPARE: u32;
    /// The exponent of 1.
    const BIAS: u32;
    /// The exponent of infinities and NaN.
    const SPECIAL: u32 = 2 * Self::BIAS + 1;

    /// The lower 32 bits.
    fn low(self) -> u32;
    /// The sum without a carry.
    fn wrapping_add(self, other: Self) -> Self;
    /// The difference without a borrow.
    fn wrapping_sub(self, other: Self) -> Self;
    /// Shifted left until the topmost bit is 1, and by how many places; not of 0.
    fn normalised(self) -> (u32, Self);
    /// The upper half of the product; its last bit is 1 if anything of the lower half is.
    fn high_product(self, other: Self) -> Self;
    /// Shifted right by less than all places; the last bit is 1 if anything is shifted out, which is all that rounding
    /// needs to know of it.
    fn jammed(self, places: u32) -> Self;
}

impl Word for u32 {
    const ZERO: Self = 0;
    const ONE: Self = 1;
    const SIGN: Self = 1 << 31;
    const FRACTION: u32 = f32::MANTISSA_DIGITS - 1;
    const SPARE: u32 = u32::BITS - f32::MANTISSA_DIGITS;
    const BIAS: u32 = (f32::MAX_EXP - 1) as u32;

    #[inline(always)]
    fn low(self) -> u32 {
        self
    }

    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        u32::wrapping_add(self, other)
    }

    #[inline(always)]
    fn wrapping_sub(self, other: Self) -> Self {
        u32::wrapping_sub(self, other)
    }

    #[inline(always)]
    fn normalised(self) -> (u32, Self) {
        let zeros = self.leading_zeros();
        (zeros, self << (zeros & 31))
    }

    #[inline(always)]
    fn high_product(self, other: Self) -> Self {
        let product = u64::from(self) * u64::from(other);
        (product >> 32) as u32 | u32::from(product as u32 != 0)
    }

    #[inline(always)]
    fn jammed(self, places: u32) -> Self {
        let shifted = self >> places;
        shifted | u32::from(shifted << places != self)
    }
}

impl Word for u64 {
    const ZERO: Self = 0;
    const ONE: Self = 1;
    const SIGN: Self = 1 << 63;
    const FRACTION: u32 = f64::MANTISSA_DIGITS - 1;
    const SPARE: u32 = u64::BITS - f64::MANTISSA_DIGITS;
    const BIAS: u32 = (f64::MAX_EXP - 1) as u32;

    #[inline(always)]
    fn low(self) -> u32 {
        self as u32
    }

    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        u64::wrapping_add(self, other)
    }

    #[inline(always)]
    fn wrapping_sub(self, other: Self) -> Self {
        u64::wrapping_sub(self, other)
    }

    #[inline(always)]
    fn normalised(self) -> (u32, Self) {
        let (high, low) = ((self >> 32) as u32, self as u32);
        if high == 0 {
            let zeros = low.leading_zeros();
            (32 + zeros, u64::from(low << (zeros & 31)) << 32)
        } else {
            let zeros = high.leading_zeros();
            (zeros, self << (zeros & 31))
        }
    }

    /// Of halves: what the processor multiplies in one instruction, the sums in none of which anything is carried out.
    #[inline(always)]
    fn high_product(self, other: Self) -> Self {
        let halves = |word: u64| (word & u64::from(u32::MAX), word >> 32);
        let ((a0, a1), (b0, b1)) = (halves(self), halves(other));
        let lowest = a0 * b0;
        let middle = a0 * b1 + (lowest >> 32);
        let (middle, carried) = halves(middle);
        let middle = a1 * b0 + middle;
        let highest = a1 * b1 + carried + (middle >> 32);
        highest | u64::from((lowest as u32 | middle as u32) != 0)
    }

    /// In halves, as the processor shifts.
    #[inline(always)]
    fn jammed(self, places: u32) -> Self {
        let lost = |half: u32| half & ((1 << (places & 31)) - 1);
        let (high, low) = ((self >> 32) as u32, self as u32);
        if places < 32 {
            (self >> (places & 31)) | u64::from(lost(low) != 0)
        } else {
            u64::from(high >> (places & 31)) | u64::from(lost(high) | low != 0)
        }
    }
}
