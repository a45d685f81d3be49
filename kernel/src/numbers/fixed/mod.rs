//! Fixed point: numbers of 32 and 64 bits that hold one motion, in units that its energy chooses.

mod product;
mod q30;
mod q64;

pub(crate) use product::{IN_HALVES, product};
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
