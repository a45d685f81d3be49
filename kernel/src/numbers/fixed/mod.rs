//! Fixed point: numbers of 32 and 64 bits that hold one motion, in units that its energy chooses.

/// A number whose sums are those of its words, of which `$narrowed` puts what is twice as wide back into a word.
macro_rules! fixed_point {
    ($(#[$doc:meta])* $type:ident($word:ident), $narrowed:ident($wide:ident)) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) struct $type(pub $word);

        impl core::ops::Add for $type {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self($narrowed($wide::from(self.0) + $wide::from(other.0)))
            }
        }
        impl core::ops::Sub for $type {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self($narrowed($wide::from(self.0) - $wide::from(other.0)))
            }
        }
        impl core::ops::Neg for $type {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self($narrowed(-$wide::from(self.0)))
            }
        }
    };
}

mod q30;
mod q64;

#[cfg(test)]
pub(crate) use q30::watch;
pub(crate) use q30::{Gravity, Q30, Slope, Torque, word};
pub(crate) use q64::Q64;

/// `value` times 2^`exponent`; one copy, as is [`nearest`].
#[inline(never)]
pub(crate) fn scaled(value: f64, exponent: i32) -> f64 {
    libm::scalbn(value, exponent)
}

/// The nearest whole number.
#[inline(never)]
pub(crate) fn nearest(value: f64) -> f64 {
    libm::rint(value)
}

/// Whether the processor has no product of two words: the Cortex-M0 and M0+, which are known by what else they lack, an exchange
/// of words in one go. The compiler's library has one, at twice the price.
pub(crate) const IN_HALVES: bool = cfg!(all(
    target_arch = "arm",
    target_os = "none",
    not(target_has_atomic = "32")
));

/// The upper word of a product, which elsewhere is the instruction's second register: rounded down.
#[inline(always)]
pub(crate) fn upper(a: i32, b: i32) -> i32 {
    (product(a, b) >> 32) as i32
}

/// The product of two words.
#[inline(always)]
pub(crate) fn product(a: i32, b: i32) -> i64 {
    if IN_HALVES {
        product_of_halves(a, b)
    } else {
        i64::from(a) * i64::from(b)
    }
}

/// The same by four products of half words; no sum on the way is carried out of its word.
#[inline(always)]
fn product_of_halves(a: i32, b: i32) -> i64 {
    let halves = |word: i32| (word & 0xffff, word >> 16);
    let ((a0, a1), (b0, b1)) = (halves(a), halves(b));
    let lowest = a0.wrapping_mul(b0) as u32;
    let (middle, carried) = halves(a1 * b0 + (lowest >> 16) as i32);
    let (upper, middle) = (a1 * b1 + carried, a0 * b1 + middle);
    let lower = lowest & 0xffff | (middle as u32) << 16;
    i64::from(upper + (middle >> 16)) << 32 | i64::from(lower)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_give_what_the_whole_gives() {
        let ends = [
            0,
            1,
            -1,
            0x7fff,
            0x8000,
            0xffff,
            0x1_0000,
            -0x8000,
            -0x1_0000,
            i32::MAX,
            i32::MIN,
            i32::MIN + 1,
        ];
        let mut rng = fastrand::Rng::with_seed(1);
        let drawn: [i32; 64] = core::array::from_fn(|_| rng.i32(..) >> rng.u8(..16));
        for a in ends.into_iter().chain(drawn) {
            for b in ends.into_iter().chain(drawn) {
                assert_eq!(
                    product_of_halves(a, b),
                    i64::from(a) * i64::from(b),
                    "{a:#x} {b:#x}"
                );
            }
        }
    }
}
