//! The ways to compute a scene, and what each costs on a target.

use crate::error::{Error, Parameter};

/// A way to compute a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Way {
    /// [`SmallOscillations`](crate::SmallOscillations) in `f32`: no steps at all.
    ClosedForm,
    /// [`PictureForm`](crate::form::PictureForm), plain `f32`.
    PicturePlain,
    /// [`PictureForm`](crate::form::PictureForm), compensated `f32`.
    Picture,
    /// [`AngleForm`](crate::form::AngleForm), compensated `f32`.
    Angle,
    /// [`PictureForm8`](crate::form::PictureForm8), compensated `f64`: steps of order 8.
    Picture8,
}

impl Way {
    /// Every way.
    pub const ALL: [Way; 5] = [Way::ClosedForm, Way::PicturePlain, Way::Picture, Way::Angle, Way::Picture8];

    /// Model, arithmetic and method in words.
    pub const fn name(self) -> &'static str {
        match self {
            Way::ClosedForm => "normal modes in closed form, f32",
            Way::PicturePlain => "picture form, RK4, plain f32",
            Way::Picture => "picture form, RK4, compensated f32",
            Way::Angle => "angle form, RK4, compensated f32",
            Way::Picture8 => "picture form, order 8, compensated f64",
        }
    }
}

/// Cycles of a step in each way on one target; of a picture for the closed form.
///
/// The constants are the high estimates of `cargo count` for steps of 1/256 s, masses and lengths alike (test `count` holds
/// them to within a tenth).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// [`Way::ClosedForm`], for each picture.
    pub closed_form: f32,
    /// [`Way::PicturePlain`].
    pub picture_plain: f32,
    /// [`Way::Picture`].
    pub picture: f32,
    /// [`Way::Angle`].
    pub angle: f32,
    /// [`Way::Picture8`].
    pub picture8: f32,
}

impl Costs {
    /// Cortex-M3, which has no floating-point unit.
    pub const CORTEX_M3: Self =
        Self { closed_form: 5_545.0, picture_plain: 9_803.0, picture: 11_265.0, angle: 16_661.0, picture8: 139_600.0 };
    /// Cortex-M4F, whose floating-point unit knows `f32` only. A plain step costs less than the closed form's two sincos.
    pub const CORTEX_M4F: Self =
        Self { closed_form: 289.0, picture_plain: 160.4, picture: 214.0, angle: 376.0, picture8: 135_450.0 };

    pub(super) fn check(&self) -> Result<(), Error> {
        check_positive(Parameter::Cost, Way::ALL.map(|way| self.of_frame(way, 1)))
    }

    /// Cycles of a picture computed in `way` with `steps`.
    pub fn of_frame(&self, way: Way, steps: u32) -> f32 {
        match way {
            Way::ClosedForm => self.closed_form,
            Way::PicturePlain => self.picture_plain * steps as f32,
            Way::Picture => self.picture * steps as f32,
            Way::Angle => self.angle * steps as f32,
            Way::Picture8 => self.picture8 * steps as f32,
        }
    }
}

/// What may be spent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// On computing a picture, cycles.
    pub frame: f32,
    /// On looking ahead, cycles.
    pub planning: f32,
}

impl Budget {
    /// Of a `clock` (Hz) with `rate` pictures per second: half of the time between pictures, the other half is for drawing;
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
