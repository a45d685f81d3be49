//! The pendulum in forms that step fast at a fixed step, on the directions of its rods alone.
//!
//! [`Pendulum::step`](crate::Pendulum::step) is the classical method as one writes it down. The forms here do the same
//! in the units of the step, with fewer operations, and carry the rounding error of their additions along unless told
//! otherwise. Cost of a step on a Cortex-M4F (estimated cycles, equal rods or not) and largest error in rad within
//! 10 s and 100 s of regular motion (0.5 rad, dt = 1/256 s; root mean square over neighbouring starts; the
//! method's own error is 1e-8 and 1e-7):
//!
//! | form | cycles | 10 s | 100 s |
//! |---|---|---|---|
//! | [`DirectionForm`] compensated, `f32` | 206 | 4e-8 | 4e-7 |
//! | [`DirectionForm`] plain, `f32` | 160 | 2e-6 | 2e-5 |
//!
//! Where an error of 1e-9 or less is wanted, [`ExtrapolatedForm`] takes far fewer steps in `f64`; on chips that compute `f64` in
//! software [`Fixed64Form`] does the same for a tenth of the cycles.
//!
//! ```
//! use double_pendulum::methods::{DirectionForm, Stepper};
//! use double_pendulum::{Parameters, State};
//!
//! let pendulum = Parameters::equal_rods(1.0, 1.0, 9.81);
//! let mut motion = Stepper::<f32, DirectionForm<f32>>::new(&pendulum, &State::at_rest(0.5, 0.5), 1.0 / 256.0)?;
//! motion.try_advance(256)?;
//! let [[sin1, cos1], [sin2, cos2]] = motion.directions(); // enough to draw both rods
//! assert!((sin1 * sin1 + cos1 * cos1 - 1.0).abs() < 1e-6 && (sin2 * sin2 + cos2 * cos2 - 1.0).abs() < 1e-6);
//! # Ok::<(), double_pendulum::Error>(())
//! ```

pub(crate) mod direction;
pub mod extrapolation;
mod fixed32;
mod fixed64;
mod heads;
pub mod rk4;
mod run;
mod scaling;
mod turns;

pub use direction::{Compensated, DirectionForm, DirectionState, ExtrapolatedForm, ExtrapolatedState, Plain, Sum};
pub use fixed32::{Fixed32Form, Fixed32State};
pub use fixed64::{Fixed64Form, Fixed64State};
pub use heads::{Part, Watched};
pub use run::{Stepper, UnwrappedStepper};
pub use turns::Winding;

use crate::error::{Error, Parameter, check_finite};
use crate::numbers::{Real, Sealed};
use crate::pendulum::{Direction, Parameters, State};

/// A pendulum and a step size, prepared: configuration that drives any number of motions; sealed.
///
/// For one motion, [`Stepper`] keeps it together with what it carries.
pub trait Form<R: Real>: Sealed + Copy + core::fmt::Debug + PartialEq {
    /// A motion: what is carried from step to step.
    type Carried: Copy + core::fmt::Debug + PartialEq;

    /// The order of accuracy: as the step shrinks, errors do as this power of it.
    const ORDER: u32;

    /// Checks the parameters and prepares steps of `dt` seconds; a negative one runs backwards.
    ///
    /// 1/240 s is as good as 1/256 s, though no `f32` holds it: the constants of a step are rounded so that it is longer than
    /// dt by a share that is known, up to 2e-6 in `f32`. Half a step ahead, one step is left out; [`state`](Self::state)
    /// takes back the rest. [`directions`](Self::directions) may be half a step ahead.
    ///
    /// Refuses what [`Pendulum::new`](crate::Pendulum::new) refuses, and a step that is NaN, infinite, zero or subnormal.
    /// Not one that is too long, because what is too long depends on the motion: above
    /// [`Modes::step_limit`](crate::Modes::step_limit) even the smallest swing grows with every step of RK4
    /// ([`Pendulum::check_step`](crate::Pendulum::check_step) refuses that), and a motion of given energy is sure to be
    /// resolved up to [`Pendulum::admissible_step`](crate::Pendulum::admissible_step).
    fn new(parameters: &Parameters<R>, dt: f64) -> Result<Self, Error>;

    /// The motion that starts from `state`.
    ///
    /// Refuses NaN and infinite values and momenta out of range.
    fn start(&self, state: &State<R>) -> Result<Self::Carried, Error>;

    /// Makes `steps` steps. How they are dealt out to calls makes no difference to any bit.
    fn advance(&self, carried: &mut Self::Carried, steps: u32);

    /// As [`advance`](Self::advance), but all or nothing: [`Error::Diverged`] if the steps led out of the finite numbers,
    /// and `carried` stays as it was.
    ///
    /// Asked once for all the steps, at the cost of one [`state`](Self::state) and [`directions`](Self::directions).
    fn try_advance(&self, carried: &mut Self::Carried, steps: u32) -> Result<(), Error> {
        let mut next = *carried;
        self.advance(&mut next, steps);
        self.state(&next).finite()?;
        // A lost motion may have an angle and yet no direction: the direction form's lengths overflow first.
        let [[sin1, cos1], [sin2, cos2]] = self.directions(&next);
        check_finite([(Parameter::A1, sin1), (Parameter::A1, cos1), (Parameter::A2, sin2), (Parameter::A2, cos2)])
            .map_err(Error::diverged)?;
        *carried = next;
        Ok(())
    }

    /// The directions of the two rods, all that a drawing needs; no trigonometry. Of the motion as it is carried, up to half a
    /// step ahead of the [`state`](Self::state).
    #[must_use]
    fn directions(&self, carried: &Self::Carried) -> [Direction<R>; 2];

    /// The canonical momenta p1 and p2, kg m^2/s, when the rods point to the [`directions`](Self::directions): both together
    /// have the motion's energy.
    #[must_use]
    fn momenta(&self, carried: &Self::Carried) -> [R; 2];

    /// The canonical state in SI units, to the last digit carried, at the number of steps times dt.
    ///
    /// The motion carried may be ahead of that time by up to half a step ([`new`](Self::new)). It is taken back here, which
    /// alters the energy by 1e-4 of itself at most where the fastest frequency times dt is 0.2 or less (the repository's tests
    /// assert it over a day).
    #[must_use]
    fn state(&self, carried: &Self::Carried) -> State<f64>;

    /// Gives `feed` the bit patterns of all that is carried, the number of steps among them, to compare machines by.
    fn bits(carried: &Self::Carried, feed: impl FnMut(u64));
}
