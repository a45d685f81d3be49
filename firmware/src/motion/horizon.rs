//! The accuracy horizon of a scene.

/// The time until which the frames of a scene are within [half a
/// pixel](crate::config::HALF_PIXEL) of the exact motion, s after the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Horizon {
    /// Every frame is accurate, because nothing that is drawn can be inaccurate.
    #[default]
    Always,
    /// Not known yet: planning goes on, and has not verified the current frame.
    Undecided,
    /// At least this time, which is not past. Planning goes on, and may raise it.
    AtLeast(f32),
    /// This time. Planning has ended.
    Until(f32),
}

impl Horizon {
    /// Returns the verified time, s: 0 if none is, infinity if the frames are always accurate.
    #[must_use]
    pub fn verified(self) -> f32 {
        match self {
            Self::Always => f32::INFINITY,
            Self::Undecided => 0.0,
            Self::AtLeast(time) | Self::Until(time) => time,
        }
    }

    /// Returns true if planning goes on.
    #[must_use]
    pub fn is_open(self) -> bool {
        matches!(self, Self::Undecided | Self::AtLeast(_))
    }

    /// Returns true if frames at `time`, s, are no longer predicted to be accurate.
    #[must_use]
    pub fn is_past(self, time: f64) -> bool {
        matches!(self, Self::Until(end) if time > f64::from(end))
    }
}
