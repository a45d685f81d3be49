//! On which side of straight up a rod is: all that a passage through it is seen by.

use crate::numbers::{Real, Sealed};

/// A sine or cosine, of which the sign tells the side; sealed.
pub trait Side: Sealed + Copy + core::fmt::Debug + PartialEq + 'static {
    /// All bits where it is negative; 0 where not. A negative zero is.
    fn sign(self) -> i32;
    /// How far it is to zero, on the way to `next`, as a share of the way.
    fn share<R: Real>(self, next: Self) -> R;
}

macro_rules! side {
    ($number:ident, $sign:expr) => {
        impl Side for $number {
            #[inline(always)]
            fn sign(self) -> i32 {
                $sign(self)
            }
            fn share<R: Real>(self, next: Self) -> R {
                let [before, after] = [self, next].map(|part| R::from_f64(part.into()));
                before / (before - after)
            }
        }
    };
}

side!(f32, |part: f32| (part.to_bits() as i32) >> 31);
side!(f64, |part: f64| ((part.to_bits() >> 32) as i32) >> 31);
side!(i32, |part: i32| part >> 31);

impl Sealed for i32 {}

/// Negative if the sine's sign, first before and then after, has changed, and the cosine's is negative.
#[inline(always)]
pub(crate) fn turns_over([from, to, cos]: [i32; 3]) -> i32 {
    (from ^ to) & cos
}
