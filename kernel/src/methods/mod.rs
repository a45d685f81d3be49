//! The numerical methods: a type for each row of the [table](crate::Method).
//!
//! [`Pendulum::run`](crate::Pendulum::run) takes the type of a method and returns a motion. All
//! inputs and results are in SI units and rad.

pub(crate) mod any;
mod canonical;
mod closed_form;
pub(crate) mod direction;
pub mod extrapolation;
mod extrapolation_f64;
mod extrapolation_fixed64;
pub mod rk4;
mod rk4_direction;
mod rk4_fixed32;
mod run;
mod scaling;
pub(crate) mod turns;

pub(crate) use any::DrawnMotion;
pub use any::FormVisitor;
pub use canonical::{Canonical, Derivatives, Rk4, RungeKutta};
pub use closed_form::{ClosedForm, SmallOscillations};
pub use extrapolation_f64::ExtrapolationF64;
pub use extrapolation_fixed64::Fixed64;
pub(crate) use extrapolation_fixed64::{StepErrors, Truncation};
pub use rk4_direction::Rk4Direction;
pub use rk4_fixed32::Fixed32;
pub use run::Run;
pub use turns::Turns;

use core::fmt::Debug;

use crate::bounds::RK4_STABLE;
use crate::error::Error;
use crate::numbers::Real;
use crate::pendulum::{Direction, Parameters, Pendulum, State};

/// RK4 on Hamilton's equations in angles and momenta, in `f32`: `rk4-f32`.
///
/// A step is dt rounded to `f32`, so that the motion is off the time by up to 6e-8 of it. Angles
/// include whole turns, so that they have fewer digits after many turns.
pub type HamiltonF32 = Canonical<f32>;
/// RK4 on Hamilton's equations in angles and momenta, in `f64`: `rk4-f64`. A step is dt exactly.
/// Angles include whole turns.
pub type HamiltonF64 = Canonical<f64>;
/// RK4 in the direction form, in `f32` with compensated sums: `rk4-f32-direction`. Angles are
/// within [-pi, pi]; [`Run`] counts the turns on request.
///
/// The error is within 5e-8 rad in 10 s of a regular
/// motion, as the root mean square over neighbouring starts: 256 steps per second, from rest with
/// both rods at 0.5 rad, rods of 1 m, bobs of 1 kg.
pub type DirectionF32 = Rk4Direction<f32, true>;
/// [`DirectionF32`] with plain sums: `rk4-f32-direction-plain`. A step is a fifth cheaper on a
/// Cortex-M4F. The error in the same motion is within 3e-6 rad.
pub type DirectionF32Plain = Rk4Direction<f32, false>;
/// RK4 in the direction form, in `f64` with compensated sums. It is not in the table of methods.
pub type DirectionF64 = Rk4Direction<f64, true>;
/// [`SmallOscillations`] in closed form, in `f32`: `closed-form-f32`.
///
/// Each step is computed from the start, so that errors do not add up. Angles include whole turns.
/// The pendulum must have gravity.
pub type ClosedFormF32 = ClosedForm<f32>;
/// [`ClosedFormF32`] in `f64`: `closed-form-f64`.
pub type ClosedFormF64 = ClosedForm<f64>;

/// A method: its equations, its numbers and its integrator. A value is a motion of a pendulum.
///
/// The trait is sealed. Pass the type of a method to [`Pendulum::run`](crate::Pendulum::run).
/// `F::Real` is the type of its numbers, `f32` for fixed point.
///
/// # Time
///
/// In the direction form in floating point, rounded constants make a step longer than dt by a known
/// share, up to 2e-6 in `f32` and 4e-15 in `f64`, never shorter by more than a rounding of `f64`.
/// If the motion would be more than half a step ahead of the time, RK4 leaves out one step, and the
/// motion is about half a step behind. [`Run::state`] takes back the difference, so that a step of
/// 1/240 s is as accurate as one of 1/256 s, although no `f32` is 1/240. The directions, angles and
/// the energy may be up to half a step ahead or behind.
///
/// Fixed point, the closed form and [`HamiltonF64`] are neither ahead nor behind. [`HamiltonF32`]
/// is, because it rounds dt, and its state is not corrected.
pub trait Form: FormOperations {}

impl<F: FormOperations> Form for F {}

/// The operations of a motion in progress, by a type of a method or by an enum of several
/// ([`motions!`](crate::motions)), without checks and turns.
pub trait Advance: Copy + Debug + PartialEq + 'static {
    /// Returns a motion of the same pendulum from another start, in the same units and steps. This
    /// motion may have diverged. In fixed point the energy must not exceed that of the first start;
    /// [`Fixed32`] has room for an eighth more.
    fn started(&self, start: &State<f64>) -> Result<Self, Error>;

    /// Advances the motion by `steps` steps. [`check`](Self::check) it afterwards.
    ///
    /// `advance(a); advance(b)` is bit-identical to `advance(a + b)`.
    fn advance(&mut self, steps: u32);

    /// Refuses a motion that has diverged, by [`Error::Diverged`]: its numbers are not finite or,
    /// in fixed point, were ever out of range. In floating point a motion whose numbers are finite
    /// but meaningless is accepted.
    fn check(&self) -> Result<(), Error>;

    /// Returns `[[sin a1, cos a1], [sin a2, cos a2]]` at the time of the
    /// [`directions`](Self::directions), as words whose highest bit is the sign; a zero may have
    /// either. The signs show when a rod turns over. The other bits are in the format of the
    /// method's numbers.
    fn sides(&self) -> [[i32; 2]; 2];

    /// Returns the directions of rod 1 and rod 2, (sin, cos) each. They may be up to half a step
    /// ahead of the [`state`](Self::state) or behind it. In fixed point they stay finite if the
    /// motion diverges.
    fn directions<Q: Real>(&self) -> [Direction<Q>; 2];

    /// Returns the momenta p1 and p2, kg m^2/s, at the time of the
    /// [`directions`](Self::directions).
    fn momenta<Q: Real>(&self) -> [Q; 2];

    /// Returns the canonical state in SI units at the number of steps times dt, with all digits
    /// that the method carries; NaN if the motion has diverged in fixed point. The angles are in
    /// [-pi, pi], unless it [has turns](Self::has_turns).
    fn state(&self) -> State<f64>;

    /// Returns the energy above rest, J, at the time of the [`directions`](Self::directions), with
    /// all digits that the method carries. `pendulum` is that of this motion.
    fn energy_above_rest(&self, pendulum: &Pendulum<f64>) -> f64 {
        let [upper, lower] = self.directions();
        pendulum.energy_above_rest_at([unit(upper), unit(lower)], self.momenta())
    }

    /// Returns true if the angles of the [`state`](Self::state) include whole turns.
    fn has_turns(&self) -> bool {
        false
    }
}

/// The operations of a [`Form`] beyond those of every motion.
///
/// No other crate can name this trait, so that [`Form`] is sealed and may get new operations.
pub trait FormOperations: Advance {
    /// The numbers that [`Run::directions`], [`Run::angles`] and [`Run::energy`] return.
    type Real: Real;

    /// The largest phase w1 dt, rad, of a stable step; w1 is the frequency of the fast normal mode.
    /// [`Pendulum::run`](crate::Pendulum::run) refuses longer steps. It is infinite if
    /// [`new`](Self::new) applies a limit, or if there is none.
    const STABLE: f64 = RK4_STABLE;

    /// True if [`Run`] need not check the energy and the lengths of the directions, because
    /// [`check`](Advance::check) does or, by the closed form, they cannot grow.
    const CHECKS_ENERGY: bool = false;

    /// Checks the parameters and prepares the motion from `start`, in steps of `dt` seconds,
    /// backwards if negative.
    ///
    /// # Errors
    ///
    /// Refuses the inputs that [`Pendulum::run`](crate::Pendulum::run) refuses, except a step
    /// beyond [`STABLE`](Self::STABLE) and, with directions, a start of too many turns.
    fn new(parameters: &Parameters<f64>, start: &State<f64>, dt: f64) -> Result<Self, Error>;

    /// Advances the motion by one step, for a loop that reads the motion after each.
    fn advance_one(&mut self) {
        self.advance(1);
    }

    /// Returns the number that a word of [`sides`](Advance::sides) represents, in a unit that may
    /// differ between the rods.
    fn side_value(side: i32) -> Self::Real;

    /// Returns the [`momenta`](Advance::momenta) to a few units in the last place, enough for a
    /// check of the energy.
    fn momenta_nearly(&self) -> [Self::Real; 2] {
        self.momenta()
    }

    /// Passes the words that the motion carries from step to step to `feed`, always in the same
    /// order, to compare machines. The bits of an `f32` are the lower 32 of a word.
    fn bits(&self, feed: impl FnMut(u64));
}

/// Returns the same direction with length 1.
pub(crate) fn unit([sin, cos]: Direction<f64>) -> Direction<f64> {
    let inverse = 1.0 / libm::sqrt(sin * sin + cos * cos);
    [sin * inverse, cos * inverse]
}
