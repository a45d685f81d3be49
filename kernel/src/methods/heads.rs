//! Where the rods point, as a form has it: all that a passage through straight up is seen by.

use super::Form;
use super::direction::Sum;
use super::direction::{DirectionForm, DirectionState};
use super::fixed32::{Fixed32Form, Fixed32State};
use crate::error::Error;
use crate::numbers::{Real, Sealed};
use crate::pendulum::directions::heads;
use crate::pendulum::{Direction, State};

/// A form whose rods can be watched at each step at little cost: the direction form in `f32` and `f64`, and
/// [`Fixed32Form`]; sealed.
pub trait Watched<R: Real>: Form<R> {
    /// The number a direction is made of.
    #[doc(hidden)]
    type Part: Part;
    /// The directions of both rods, that of rod 2 by nu = l1/l2 or near it.
    #[doc(hidden)]
    fn heads(carried: &Self::Carried) -> [Direction<Self::Part>; 2];
    /// The motion that starts from `state`, whose energy is at most that of `above`: in the same units.
    #[doc(hidden)]
    fn start_below(&self, above: &Self::Carried, state: &State<R>) -> Result<Self::Carried, Error>;
    /// As [`advance`](Form::advance) by one step, for a loop that looks at each.
    #[doc(hidden)]
    #[inline(always)]
    fn advance_one(&self, carried: &mut Self::Carried) {
        self.advance(carried, 1);
    }
}

impl<R: Real + Part, S: Sum<R>> Watched<R> for DirectionForm<R, S> {
    type Part = R;
    #[inline(always)]
    fn heads(carried: &DirectionState<R, S>) -> [Direction<R>; 2] {
        heads(&carried.z)
    }
    fn start_below(&self, _: &DirectionState<R, S>, state: &State<R>) -> Result<DirectionState<R, S>, Error> {
        self.start(state)
    }
    #[inline(always)]
    fn advance_one(&self, carried: &mut DirectionState<R, S>) {
        self.run(carried, 1);
    }
}

impl<R: Real> Watched<R> for Fixed32Form {
    type Part = i32;
    #[inline(always)]
    fn heads(carried: &Fixed32State) -> [Direction<i32>; 2] {
        heads(&carried.quantities()).map(|direction| direction.map(|part| part.0))
    }
    fn start_below(&self, above: &Fixed32State, state: &State<R>) -> Result<Fixed32State, Error> {
        above.start(state)
    }
}

/// A sine or cosine, of which the sign tells on which side of straight up a rod is; sealed.
pub trait Part: Sealed + Copy + core::fmt::Debug + PartialEq + 'static {
    /// All bits where it is negative; 0 where not. A negative zero is.
    #[doc(hidden)]
    fn sign(self) -> i32;
    /// How far it is to zero, on the way to `next`, as a share of the way.
    #[doc(hidden)]
    fn share<R: Real>(self, next: Self) -> R;
}

macro_rules! part {
    ($number:ident, $sign:expr) => {
        impl Part for $number {
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

part!(f32, |part: f32| (part.to_bits() as i32) >> 31);
part!(f64, |part: f64| ((part.to_bits() >> 32) as i32) >> 31);
part!(i32, |part: i32| part >> 31);

impl Sealed for i32 {}
