//! The methods to compute a motion, what each costs, and what may be spent.

use super::error::{PlanError, Quantity, check_positive};

/// The order of the steps in 64 bits of fixed point. 8 lasts less long, 12 costs 1.4 times as much and lasts no longer: the
/// roundings end the horizon.
pub const ORDER: u32 = 10;

/// A method to compute a motion: model, arithmetic and stepper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Method {
    /// [`SmallOscillations`](crate::SmallOscillations) in `f32`: no steps at all.
    ClosedForm,
    /// [`DirectionForm`](crate::form::DirectionForm), plain `f32`.
    DirectionPlain,
    /// [`DirectionForm`](crate::form::DirectionForm), compensated `f32`.
    Direction,
    /// [`Fixed32Form`](crate::form::Fixed32Form): integers of 32 bits.
    Fixed32,
    /// [`Fixed64Form`](crate::form::Fixed64Form): integers of 64 bits, steps of order [`ORDER`].
    Fixed64,
}

impl Method {
    /// Every method, in no order that means anything.
    pub const ALL: &[Method] =
        &[Method::ClosedForm, Method::DirectionPlain, Method::Direction, Method::Fixed32, Method::Fixed64];

    /// Model, stepper and arithmetic in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Method::ClosedForm => "normal modes in closed form, f32",
            Method::DirectionPlain => "direction form, RK4, plain f32",
            Method::Direction => "direction form, RK4, compensated f32",
            Method::Fixed32 => "direction form, RK4, 32-bit fixed point",
            Method::Fixed64 => "direction form, order 10, 64-bit fixed point",
        }
    }
}

/// The price list: what a step costs by each method, what a frame costs in closed form. In cycles, or in any other unit
/// that the [`Budget`] is given in, too.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Costs {
    /// [`Method::ClosedForm`], for each frame.
    pub closed_form: f32,
    /// [`Method::DirectionPlain`].
    pub direction_plain: f32,
    /// [`Method::Direction`].
    pub direction: f32,
    /// [`Method::Fixed32`].
    pub fixed32: f32,
    /// [`Method::Fixed64`].
    pub fixed64: f32,
    /// To prepare a motion by any of them.
    pub preparation: f32,
}

impl Costs {
    pub(super) fn check(&self) -> Result<(), PlanError> {
        let Self { closed_form, direction_plain, direction, fixed32, fixed64, preparation } = *self;
        let costs = [closed_form, direction_plain, direction, fixed32, fixed64, preparation];
        check_positive(Quantity::Cost, &costs.map(f64::from))
    }

    /// What a frame costs that is computed by `method` with `steps`.
    #[must_use]
    #[inline(never)] // once in flash
    pub fn of_frame(&self, method: Method, steps: u32) -> f32 {
        let step = match method {
            Method::ClosedForm => return self.closed_form,
            Method::DirectionPlain => self.direction_plain,
            Method::Direction => self.direction,
            Method::Fixed32 => self.fixed32,
            Method::Fixed64 => self.fixed64,
        };
        step * steps as f32
    }
}

/// What may be spent, in the unit of the [`Costs`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Budget {
    /// On computing a frame.
    pub frame: f32,
    /// On looking ahead.
    pub planning: f32,
}

impl Budget {
    pub(super) fn check(&self) -> Result<(), PlanError> {
        check_positive(Quantity::FrameBudget, &[self.frame.into()])?;
        check_positive(Quantity::PlanningBudget, &[self.planning.into()])
    }
}
