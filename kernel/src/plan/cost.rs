//! The ways to compute a scene, and what each costs on a target.

use crate::error::{Error, Parameter};

/// A way to compute a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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
    /// Every way.
    pub const ALL: [Method; 5] =
        [Method::ClosedForm, Method::DirectionPlain, Method::Direction, Method::Angle, Method::Direction8];

    /// Model, arithmetic and method in words.
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

/// Cycles of a step in each way on one target; of a frame for the closed form.
///
/// The constants are the estimates of `cargo count` for steps of 1/256 s, masses and lengths alike (test `count` holds
/// them to within a tenth).
#[derive(Clone, Copy, Debug, PartialEq)]
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
    /// Cortex-M3, which has no floating-point unit.
    pub const CORTEX_M3: Self = Self {
        closed_form: 5_087.0,
        direction_plain: 8_915.0,
        direction: 10_210.0,
        angle: 15_170.0,
        direction8: 136_500.0,
    };
    /// Cortex-M4F, whose floating-point unit knows `f32` only. A plain step costs less than the closed form's two sincos.
    pub const CORTEX_M4F: Self =
        Self { closed_form: 267.0, direction_plain: 159.4, direction: 208.0, angle: 360.3, direction8: 129_650.0 };

    pub(super) fn check(&self) -> Result<(), Error> {
        check_positive(Parameter::Cost, Method::ALL.map(|way| self.of_frame(way, 1)))
    }

    /// Cycles of a frame computed in `way` with `steps`.
    pub fn of_frame(&self, way: Method, steps: u32) -> f32 {
        match way {
            Method::ClosedForm => self.closed_form,
            Method::DirectionPlain => self.direction_plain * steps as f32,
            Method::Direction => self.direction * steps as f32,
            Method::Angle => self.angle * steps as f32,
            Method::Direction8 => self.direction8 * steps as f32,
        }
    }
}

/// What may be spent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// On computing a frame, cycles.
    pub frame: f32,
    /// On looking ahead, cycles.
    pub planning: f32,
}

impl Budget {
    /// Of a `clock` (Hz) with `rate` frames per second: half of the time between frames, the other half is for drawing;
    /// `planning` seconds for looking ahead.
    pub fn half_of(clock: f32, rate: u16, planning: f32) -> Self {
        Self { frame: 0.5 * clock / f32::from(rate), planning: planning * clock }
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        check_positive(Parameter::Budget, [self.frame, self.planning])
    }
}

/// Refuses what is not a positive number.
fn check_positive(parameter: Parameter, values: impl IntoIterator<Item = f32>) -> Result<(), Error> {
    for value in values.into_iter().map(f64::from) {
        if !value.is_finite() {
            return Err(Error::NotFinite { parameter, value });
        }
        if value <= 0.0 {
            return Err(Error::NotPositive { parameter, value });
        }
    }
    Ok(())
}
