//! Costs and budgets.

use super::Stepping;
use crate::methods::Fixed32;
use crate::pendulum::Parameters;
use crate::table::Method;

/// The price list of a processor: the cost of a step by each method of [`Method::DRAWN`], and of a
/// frame by the closed form. A step by [`Method::Rk4Fixed32`] has two prices;
/// [`for_pendulum`](Self::for_pendulum) selects the right one.
///
/// The unit is arbitrary, usually cycles; the [`Budget`] has the same unit. Every price must be
/// finite and more than 0, otherwise a search is refused. The lists of some processors are
/// [`CORTEX_M3`](Self::CORTEX_M3), [`CORTEX_M4F`](Self::CORTEX_M4F) and
/// [`CORTEX_M0PLUS`](Self::CORTEX_M0PLUS); that of another one begins with [`Costs::all`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive] // A new drawn method adds a price.
pub struct Costs {
    /// A frame by [`Method::ClosedFormF32`].
    pub closed_form: f32,
    /// A step by [`Method::Rk4F32DirectionPlain`].
    pub direction_plain: f32,
    /// A step by [`Method::Rk4F32Direction`].
    pub direction: f32,
    /// A step by [`Method::Rk4Fixed32`] for rods and masses that are about equal
    /// ([`Fixed32`](crate::Fixed32#cost)).
    pub fixed32: f32,
    /// A step by [`Method::Rk4Fixed32`] for other rods and masses.
    pub fixed32_unlike: f32,
    /// A step by [`Method::Extrapolation10Fixed64`] that also measures its truncation error, as in a
    /// search. A step of a motion that is shown costs 7 to 9 % less.
    pub fixed64: f32,
    /// The preparation of a motion in a search, the start of a search, or the restart of all its
    /// shadows, whichever costs the most. Shadows are five motions in 32 bits that measure how the
    /// rounding errors of a run in 64 bits grow.
    pub preparation: f32,
    /// The comparison of all methods of a search in a frame.
    pub comparison: f32,
}

impl Costs {
    /// Returns a list in which everything costs `price`, for prices of your own. With a `price`
    /// above the budget of a frame, a method without a price of its own is not chosen.
    ///
    /// On your chip, time [`PlannedRun::advance`] for a step, and [`PlannedRun::new`] for the
    /// preparation. A comparison takes a tenth to a third of a preparation.
    ///
    /// [`PlannedRun::advance`]: super::PlannedRun::advance
    /// [`PlannedRun::new`]: super::PlannedRun::new
    ///
    /// ```
    /// use double_pendulum::plan::Costs;
    ///
    /// let mut costs = Costs::all(1e9); // More than a frame may cost.
    /// costs.direction = 250.0;
    /// costs.fixed64 = 14_000.0;
    /// costs.preparation = 160_000.0;
    /// costs.comparison = 30_000.0;
    /// ```
    #[must_use]
    pub const fn all(price: f32) -> Self {
        Self {
            closed_form: price,
            direction_plain: price,
            direction: price,
            fixed32: price,
            fixed32_unlike: price,
            fixed64: price,
            preparation: price,
            comparison: price,
        }
    }

    /// Returns the price list for this pendulum: [`fixed32`](Self::fixed32) becomes
    /// [`fixed32_unlike`](Self::fixed32_unlike) if rods or masses are not about equal. A search
    /// does this itself.
    #[must_use]
    pub fn for_pendulum(self, parameters: &Parameters<f64>) -> Self {
        let fixed32 = if Fixed32::needs_shifts(parameters) {
            self.fixed32_unlike
        } else {
            self.fixed32
        };
        Self { fixed32, ..self }
    }

    /// Returns the cost of a step by `method`, or of a frame by the closed form. Returns `None` for
    /// a method that is not in [`Method::DRAWN`].
    pub(crate) const fn step(&self, method: Method) -> Option<f32> {
        Some(match method {
            Method::ClosedFormF32 => self.closed_form,
            Method::Rk4F32DirectionPlain => self.direction_plain,
            Method::Rk4F32Direction => self.direction,
            Method::Rk4Fixed32 => self.fixed32,
            Method::Extrapolation10Fixed64 => self.fixed64,
            _ => return None,
        })
    }

    /// Returns the cost of the most expensive step.
    pub(super) fn dearest_step(&self) -> f32 {
        let prices = Method::DRAWN.iter().filter_map(|&method| self.step(method));
        prices.fold(0.0, f32::max)
    }

    /// Returns the cost of a single step of this method.
    pub(super) fn of_step(&self, stepping: Stepping) -> f32 {
        self.of_frame(Stepping {
            steps: 1,
            ..stepping
        })
    }

    /// Returns the cost of a frame by this method and step count, in the unit of the prices.
    ///
    /// At any step count it is infinite for a method that is not in [`Method::DRAWN`], and
    /// [`closed_form`](Self::closed_form) for the closed form. By the other methods a step count of
    /// 0 costs 0, although a motion counts it as 1. The prices are not checked. For unlike rods or
    /// masses the list must be that [for the pendulum](Self::for_pendulum).
    #[must_use]
    #[inline(never)] // 2.4 KB more flash on an M0+ without.
    pub fn of_frame(&self, Stepping { method, steps }: Stepping) -> f32 {
        let steps = if method == Method::ClosedFormF32 {
            1
        } else {
            steps
        };
        match self.step(method) {
            Some(step) => step * steps as f32,
            None => f32::INFINITY,
        }
    }
}

// Each method for drawing has a price.
const _: () = {
    let mut i = 0;
    while i < Method::DRAWN.len() {
        let price = Costs::CORTEX_M3.step(Method::DRAWN[i]);
        assert!(price.is_some(), "a method of DrawnMotion has no price");
        i += 1;
    }
};

/// The largest costs that are allowed, in the unit of the [`Costs`]. Both must be finite and more
/// than 0, otherwise a search is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// The largest cost of computing a frame, without drawing it.
    pub frame: f32,
    /// The largest cost of all pieces of a search together.
    pub planning: f32,
}
