//! How each method of the [table](crate::Method) makes its steps: the types that [`Pendulum::run`](crate::Pendulum::run) is called with.

mod closed_form;
pub(crate) mod direction;
pub mod extrapolation;
mod extrapolation_f64;
mod extrapolation_fixed64;
pub mod rk4;
mod rk4_direction;
mod rk4_fixed32;
pub(crate) mod run;
mod scaling;

pub use closed_form::{ClosedForm, Oscillation, SmallOscillations};
pub use extrapolation_f64::ExtrapolationF64;
pub use extrapolation_fixed64::Fixed64;
pub use rk4::{Canonical, Derivatives};
pub use rk4_direction::Rk4Direction;
pub use rk4_fixed32::Fixed32;
pub use run::{Run, Turns};

use core::fmt::Debug;

use crate::bounds::RK4_STABLE;
use crate::error::Error;
use crate::numbers::{Real, Sealed};
use crate::pendulum::{Direction, Parameters, Pendulum, State};

/// Hamilton's equations as one writes them down, stepped by RK4 in `f32`: `rk4-f32`.
pub type HamiltonF32 = Canonical<f32>;
/// The same in `f64`: `rk4-f64`.
pub type HamiltonF64 = Canonical<f64>;
/// Directions of the rods, RK4, `f32` with compensated sums: `rk4-f32-direction`. On a Cortex-M4F 205 cycles a step; within
/// 4e-8 rad in 10 s of regular motion (0.5 rad, 256 steps a second), root mean square over neighbouring starts.
pub type DirectionF32 = Rk4Direction<f32, true>;
/// The same in plain sums: `rk4-f32-direction-plain`. 160 cycles, within 3e-6 rad.
pub type DirectionF32Plain = Rk4Direction<f32, false>;
/// The same in `f64`, compensated.
pub type DirectionF64 = Rk4Direction<f64, true>;
/// Small oscillations at any time without a step, in `f32`: `closed-form-f32`.
pub type ClosedFormF32 = ClosedForm<f32>;
/// The same in `f64`.
pub type ClosedFormF64 = ClosedForm<f64>;

/// A method's equations, numbers and integrator as one type: a motion of a pendulum in steps, unchecked, and as a rule without its turns;
/// sealed.
///
/// [`Pendulum::run`](crate::Pendulum::run) is called with it. Its items are machinery.
///
/// A step of 1/240 s is as good as one of 1/256 s, though no `f32` holds it: constants are rounded so that a step is longer
/// than dt by a share that is known, up to 2e-6 in `f32`. Half a step ahead, one step is left out; [`Run::state`] takes back
/// the rest. Directions may be half a step ahead.
pub trait Form: Sealed + Copy + Debug + PartialEq + 'static {
    /// What [`Run::directions`] and [`Run::angles`] are told in.
    #[doc(hidden)]
    type Real: Real;

    /// The phase w1 dt, rad, up to which [`Pendulum::run`](crate::Pendulum::run) takes the method for
    /// stable; w1 is the fast normal frequency.
    #[doc(hidden)]
    const STABLE: f64 = RK4_STABLE;

    /// True if [`check`](Self::check) notices every energy that is far too large, and every direction
    /// that is far too long. If not, [`Run`] looks at both.
    #[doc(hidden)]
    const CHECKS_ENERGY: bool = false;

    /// Checks the parameters and prepares the motion from `start` in steps of `dt` seconds; a negative one runs backwards.
    #[doc(hidden)]
    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error>;

    /// The same pendulum from another start, whose energy is no greater: in the same units.
    #[doc(hidden)]
    fn started(&self, start: &State<f64>) -> Result<Self, Error>;

    /// Makes `steps` steps. How they are dealt out to calls makes no difference to any bit.
    #[doc(hidden)]
    fn advance(&mut self, steps: u32);

    /// [`advance`](Self::advance) by one step, for a loop that looks at each.
    #[doc(hidden)]
    #[inline(always)]
    fn advance_one(&mut self) {
        self.advance(1);
    }

    /// Refuses a motion that has left the finite numbers, at the cost of a few comparisons.
    #[doc(hidden)]
    fn check(&self) -> Result<(), Error>;

    /// Returns sine and cosine of both rods as words with the sign in the highest bit. The signs
    /// show when a rod turns over; the other bits are those of the method's numbers.
    #[doc(hidden)]
    fn sides(&self) -> [[i32; 2]; 2];

    /// Returns the number of a word of [`sides`](Self::sides), in any unit.
    #[doc(hidden)]
    fn side_value(side: i32) -> Self::Real;

    /// The directions of both rods, in `Q`; no trigonometry where they are what is carried.
    #[doc(hidden)]
    fn directions<Q: Real>(&self) -> [Direction<Q>; 2];

    /// The momenta p1 and p2, kg m^2/s, when the rods point to the [`directions`](Self::directions).
    #[doc(hidden)]
    fn momenta<Q: Real>(&self) -> [Q; 2];

    /// The canonical state in SI units, to the last digit carried, at the number of steps times dt.
    #[doc(hidden)]
    fn state(&self) -> State<f64>;

    /// Returns the energy above rest, J, to the last digit carried.
    ///
    /// `pendulum` is the pendulum of this motion. The energy is that of the directions and
    /// momenta, which may be up to half a step ahead of the [`state`](Self::state).
    #[doc(hidden)]
    fn energy_above_rest(&self, pendulum: &Pendulum<f64>) -> f64 {
        let [upper, lower] = self.directions();
        pendulum.energy_above_rest_at([unit(upper), unit(lower)], self.momenta())
    }

    /// Whether [`state`](Self::state) has angles with all their turns.
    #[doc(hidden)]
    const HAS_TURNS: bool = false;

    /// Gives `feed` the bit patterns of all that is carried, the number of steps among them, to compare machines by.
    #[doc(hidden)]
    fn bits(&self, feed: impl FnMut(u64));
}

/// Returns the direction with length 1.
pub(crate) fn unit([sin, cos]: Direction<f64>) -> Direction<f64> {
    let inverse = 1.0 / libm::sqrt(sin * sin + cos * cos);
    [sin * inverse, cos * inverse]
}
