//! The methods to compute a motion, what each costs, and what may be spent.

use super::error::{PlanError, Quantity, check_positive};

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
    /// [`AngleForm`](crate::form::AngleForm), compensated `f32`.
    Angle,
    /// [`DirectionForm8`](crate::form::DirectionForm8), compensated `f64`: steps of order 8.
    Direction8,
}

impl Method {
    /// Every method, in no order that means anything.
    pub const ALL: &[Method] =
        &[Method::ClosedForm, Method::DirectionPlain, Method::Direction, Method::Angle, Method::Direction8];

    /// Model, stepper and arithmetic in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Method::ClosedForm => "normal modes in closed form, f32",
            Method::DirectionPlain => "direction form, RK4, plain f32",
            Method::Direction => "direction form, RK4, compensated f32",
            Method::Angle => "angle form, RK4, compensated f32",
            Method::Direction8 => "direction form, order 8, compensated f64",
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
    /// [`Method::Angle`].
    pub angle: f32,
    /// [`Method::Direction8`].
    pub direction8: f32,
}

impl Costs {
    pub(super) fn check(&self) -> Result<(), PlanError> {
        check_positive(Method::ALL.iter().map(|&method| (Quantity::Cost, self.of_frame(method, 1).into())))
    }

    /// What a frame costs that is computed by `method` with `steps`.
    #[must_use]
    pub fn of_frame(&self, method: Method, steps: u32) -> f32 {
        match method {
            Method::ClosedForm => self.closed_form,
            Method::DirectionPlain => self.direction_plain * steps as f32,
            Method::Direction => self.direction * steps as f32,
            Method::Angle => self.angle * steps as f32,
            Method::Direction8 => self.direction8 * steps as f32,
        }
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
        check_positive([(Quantity::FrameBudget, self.frame.into()), (Quantity::PlanningBudget, self.planning.into())])
    }
}
