//! The accuracy horizon of a scene.

use crate::graphics::label::{self, Label};

/// The time until which the frames of a scene are within [half a pixel](crate::config::HALF_PIXEL)
/// of the exact motion, s after the start.
///
/// Frames that were shown before the motion switched to the method of its plan are not part of the
/// prediction, except where the initial method is verified too.
///
/// Below, planning includes the switch to the method of the plan. In the scene `upright`, which has
/// no plan, it is the comparison with a motion in 64 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Horizon {
    /// Every frame is accurate, because the scene draws nothing inaccurate.
    #[default]
    Always,
    /// The horizon is unknown: planning is in progress, and has not verified the current frame.
    Undecided,
    /// The horizon is at least this time, s, which is not past. Planning is in progress, and may
    /// raise it.
    AtLeast(f32),
    /// The horizon is this time, s. Planning has ended. The time may be past. It is 0 if there is no
    /// promise, and for a scene that is too fast from its start.
    Until(f32),
}

impl Horizon {
    /// Returns the verified time, s after the start: 0 for `Undecided`, infinity for `Always`.
    #[must_use]
    pub fn verified(self) -> f32 {
        match self {
            Self::Always => f32::INFINITY,
            Self::Undecided => 0.0,
            Self::AtLeast(time) | Self::Until(time) => time,
        }
    }

    /// Returns the horizon as the panel shows it. `½px 8.4 s` is a final result, `½px>8.4 s` may
    /// still grow, `½px ?` means that nothing is known or that there is no promise, and `½px ok` that frames are always
    /// accurate.
    ///
    /// It is rounded down to tenths of a second, or to seconds from 1,000 s on, so that no frame is
    /// claimed that is not verified. A final result below a second is rounded to the nearest
    /// hundredth, which is shorter than a frame.
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

    /// Returns true for `Undecided` and `AtLeast`: planning is in progress, or the scene is
    /// switching to the method of the plan.
    #[must_use]
    pub fn is_open(self) -> bool {
        matches!(self, Self::Undecided | Self::AtLeast(_))
    }

    /// Returns true if planning has ended and frames at `time`, s after the start, are later than
    /// the horizon. Returns false at the horizon itself, for a `time` that is NaN, and for all
    /// variants but `Until`.
    #[must_use]
    pub fn is_past(self, time: f64) -> bool {
        matches!(self, Self::Until(end) if time > f64::from(end))
    }
}
