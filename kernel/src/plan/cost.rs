//! What each method costs, and what may be spent.

use super::error::check_positive;
use crate::error::{Error, Parameter};
use crate::table::Method;

/// The order of the steps in 64 bits of fixed point. 8 lasts less long, 12 costs 1.4 times as much and lasts no longer: the
/// roundings end the horizon.
pub(super) const ORDER: u32 = Method::Extrapolation10Fixed64.order();

/// The price list: what a step costs by each method, what a frame costs in closed form. In cycles, or in any other unit
/// that the [`Budget`] is given in, too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// [`Method::ClosedFormF32`], for each frame.
    pub closed_form: f32,
    /// [`Method::Rk4F32DirectionPlain`].
    pub direction_plain: f32,
    /// [`Method::Rk4F32Direction`].
    pub direction: f32,
    /// [`Method::Rk4Fixed32`].
    pub fixed32: f32,
    /// [`Method::Extrapolation10Fixed64`].
    pub fixed64: f32,
    /// To prepare a motion by any of them.
    pub preparation: f32,
}

impl Costs {
    pub(super) fn check(&self) -> Result<(), Error> {
        let Self { closed_form, direction_plain, direction, fixed32, fixed64, preparation } = *self;
        let costs = [closed_form, direction_plain, direction, fixed32, fixed64, preparation];
        check_positive(Parameter::Cost, &costs.map(f64::from))
    }

    /// What a frame costs that is computed by `method` with `steps`; infinite for what no plan chooses from.
    #[inline(never)] // one copy
    #[doc(hidden)]
    #[must_use]
    pub fn of_frame(&self, method: Method, steps: u32) -> f32 {
        let step = match method {
            Method::ClosedFormF32 => return self.closed_form,
            Method::Rk4F32DirectionPlain => self.direction_plain,
            Method::Rk4F32Direction => self.direction,
            Method::Rk4Fixed32 => self.fixed32,
            Method::Extrapolation10Fixed64 => self.fixed64,
            _ => f32::INFINITY,
        };
        step * steps as f32
    }
}

/// What may be spent, in the unit of the [`Costs`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// On computing a frame.
    pub frame: f32,
    /// On planning.
    pub planning: f32,
}

impl Budget {
    pub(super) fn check(&self) -> Result<(), Error> {
        check_positive(Parameter::Budget, &[self.frame.into(), self.planning.into()])
    }
}
