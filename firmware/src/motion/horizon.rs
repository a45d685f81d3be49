//! The accuracy horizon of a scene.

use crate::graphics::label::{self, Label};

/// The time until which the frames of a scene are within [half a pixel](crate::config::HALF_PIXEL)
/// of the exact motion, s after the start.
///
/// Frames that were shown before the motion switched to the method of its plan are not part of the
/// prediction, except where the initial method is verified too. In `upright`, which has no plan,
/// the horizon is that of a comparison with a motion in 64 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Horizon {
    /// Every frame is accurate, because the scene draws nothing inaccurate.
    #[default]
    Always,
    /// Planning has not reached the current frame.
    Undecided,
    /// The horizon is at least this time, s. Planning is in progress, and may raise it.
    AtLeast(f32),
    /// The horizon is this time, s. Planning has ended. It is 0 if there is no promise.
    Until(f32),
}

impl Horizon {
    /// Returns the verified time, s after the start.
    #[must_use]
    pub fn verified(self) -> f32 {
        match self {
            Self::Always => f32::INFINITY,
            Self::Undecided => 0.0,
            Self::AtLeast(time) | Self::Until(time) => time,
        }
    }

    /// Returns the horizon as the panel shows it: `½px 8.4 s` is a final result, `½px>8.4 s` may
    /// still grow, and `½px ?` is no promise.
    ///
    /// It is rounded down, so that no frame is claimed that is not verified. A final result below a
    /// second is rounded to the nearest hundredth, which is shorter than a frame.
    #[must_use]
    pub fn label(self) -> Label {
        match self {
            Self::AtLeast(until) => label::rounded_down("½px>", until),
            Self::Until(0.0) => Label::try_from("½px ?").unwrap_or_default(),
            Self::Until(until) if until < 1.0 => label::label("½px ", until, 2, " s"),
            Self::Until(until) => label::rounded_down("½px ", until),
            Self::Undecided => Label::try_from("½px ?").unwrap_or_default(),
            Self::Always => Label::try_from("½px ok").unwrap_or_default(),
        }
    }

    /// Returns true while planning is in progress.
    #[must_use]
    pub fn is_open(self) -> bool {
        matches!(self, Self::Undecided | Self::AtLeast(_))
    }

    /// Returns true if planning has ended and frames at `time` are later than the horizon.
    #[must_use]
    pub fn is_past(self, time: f64) -> bool {
        matches!(self, Self::Until(end) if time as f32 > end)
    }
}
