//! Fixed-point numbers of 32 and 64 bits.

/// Defines a number with the sums of its word. `$narrowed` decides what happens to a sum that does
/// not fit.
macro_rules! fixed_point {
    ($(#[$doc:meta])* $type:ident($word:ident), $narrowed:ident($wide:ident)) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) struct $type(pub $word);

        impl core::ops::Add for $type {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self($narrowed($wide::from(self.0) + $wide::from(other.0)))
            }
        }
        impl core::ops::Sub for $type {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self($narrowed($wide::from(self.0) - $wide::from(other.0)))
            }
        }
        impl core::ops::Neg for $type {
            type Output = Self;
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

pub(crate) fn scaled(value: f64, exponent: i32) -> f64 {
    libm::scalbn(value, exponent)
}

#[inline(never)] // With `Q64::from_f64`: 3.9 KB more flash on an M4F without.
pub(crate) fn nearest(value: f64) -> f64 {
    libm::rint(value)
}

/// True if the processor, such as a Cortex-M0+, has no instruction for the 64-bit product of two
/// words; recognised by the lack of atomic exchange. The function in the compiler's library takes
/// twice as long as [`product_of_halves`].
pub(crate) const IN_HALVES: bool = cfg!(all(
    target_arch = "arm",
    target_os = "none",
    not(target_has_atomic = "32")
));

/// Returns the upper word of the product of two words: `a` `b` 2^-32, rounded down.
pub(crate) fn upper(a: i32, b: i32) -> i32 {
    (product(a, b) >> 32) as i32
}

#[inline]
pub(crate) fn product(a: i32, b: i32) -> i64 {
    if IN_HALVES {
        product_of_halves(a, b)
    } else {
        i64::from(a) * i64::from(b)
    }
}

#[inline]
fn product_of_halves(a: i32, b: i32) -> i64 {
    let halves = |word: i32| (word & 0xffff, word >> 16);
    let (a0, a1) = halves(a);
    let (b0, b1) = halves(b);

    let lowest = a0.wrapping_mul(b0) as u32;
    let (middle, carried) = halves(a1 * b0 + (lowest >> 16) as i32);
    let upper = a1 * b1 + carried;
    let middle = a0 * b1 + middle;

    let lower = lowest & 0xffff | (middle as u32) << 16;
    i64::from(upper + (middle >> 16)) << 32 | i64::from(lower)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn product_of_halves_is_the_product() {
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
