//! How far a plan reaches, and why no farther.

/// What ends a horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Limit {
    /// The duration asked for: all of it is right.
    End,
    /// The growth of errors: nothing finer goes farther.
    Growth,
    /// The budget for a frame: finer steps or `f64` may go farther, and cost more.
    Budget,
    /// The budget for planning: no later frame was looked at.
    Planning,
    /// The method and the step that were asked for: others may go farther ([`Search::of`](super::Search::of)).
    Method,
}

impl Limit {
    /// In words.
    #[doc(hidden)]
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Limit::End => "the end of the time asked for",
            Limit::Growth => "the growth of errors",
            Limit::Budget => "the budget for a frame",
            Limit::Planning => "the budget for planning",
            Limit::Method => "what this method can do",
        }
    }
}
