//! On which side of straight up a rod is, and the whole turns that this tells of.

use crate::numbers::{Real, Sealed};
use crate::pendulum::{Direction, State};

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

/// Counts how often a direction passes straight up, by the signs of its sine and cosine.
///
/// To be shown them at least once every quarter turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turns {
    whole: i32,
    last: [i32; 2],
}

impl Turns {
    /// For angles of `start` rad, whose directions have these signs.
    #[inline(never)] // never inlined, to avoid a second copy
    #[must_use]
    pub fn of(start: [f64; 2], now: [[i32; 2]; 2]) -> [Self; 2] {
        let mut turns = start.map(|angle| {
            let whole = libm::rint(angle / core::f64::consts::TAU);
            let rest = angle - whole * core::f64::consts::TAU;
            Self { whole: whole as i32, last: [-i32::from(rest < 0.0), -1] }
        });
        Self::observe(&mut turns, now);
        turns
    }

    /// Takes note of the signs that the directions have now.
    #[inline]
    pub fn observe(both: &mut [Self; 2], now: [[i32; 2]; 2]) {
        for (turns, now) in both.iter_mut().zip(now) {
            if turns_over([turns.last[0], now[0], turns.last[1] & now[1]]) < 0 {
                turns.whole = turns.whole.wrapping_add(if now[0] < 0 { 1 } else { -1 });
            }
            turns.last = now;
        }
    }

    /// The angle with its turns, rad, of the direction last observed.
    #[inline(never)] // never inlined, to avoid a second copy
    pub fn angle<R: Real>(&self, [s, c]: Direction<R>) -> R {
        R::from_f64(f64::from(self.whole) * core::f64::consts::TAU) + s.atan2(c)
    }

    /// `state`, whose angles are known but for whole turns, with as many turns on as bring each nearest to the last direction.
    ///
    /// No trigonometry: a quarter turn to the side of that is within half a turn of it, near enough.
    #[inline(never)] // never inlined, to avoid a second copy
    #[must_use]
    pub fn unwrap([turns1, turns2]: &[Self; 2], state: State<f64>) -> State<f64> {
        use core::f64::consts::{FRAC_PI_2, TAU};
        let unwrapped = |turns: &Self, angle: f64| {
            let side = if turns.last[0] < 0 { -FRAC_PI_2 } else { FRAC_PI_2 };
            let near = f64::from(turns.whole) * TAU + side;
            angle + TAU * libm::rint((near - angle) / TAU)
        };
        State { a1: unwrapped(turns1, state.a1), a2: unwrapped(turns2, state.a2), ..state }
    }
}
