//! The choice of a method at run time.
//!
//! A [`Method`] is a name; the code that computes it is a type. This file is the only place of the
//! crate that leads from the name to the type:
//!
//! - [`Method::visit`] calls generic code with the type of a method. It links every method.
//! - [`DrawnMotion`] stores a motion by a method of [`Method::DRAWN`]. It links only these.

use super::{
    ClosedFormF32, ClosedFormF64, DirectionF32, DirectionF32Plain, ExtrapolationF64, Fixed32,
    Fixed64, Form, FormOperations, HamiltonF32, HamiltonF64,
};
use crate::error::Error;
use crate::numbers::Real;
use crate::pendulum::{Direction, Parameters, Pendulum, State};
use crate::table::{DrawnMethod, Method};

/// Generic code that [`Method::visit`] calls with the type of a method.
pub trait FormVisitor {
    /// The result of the call.
    type Output;

    /// Runs the code for the method that the type `F` computes. [`Method::visit`] calls it once, or
    /// not at all for a method whose type is not in this crate.
    fn visit<F: Form>(self) -> Self::Output;
}

impl Method {
    /// Calls `visitor` with the type that computes this method, and returns its result.
    ///
    /// Returns `None`, without a call, for `rk4-f32-micromath` and `textbook-f32`. They are listed
    /// for comparison, and their types are not in this crate.
    ///
    /// This links every method. To link one method only, pass its type to
    /// [`Pendulum::run`](crate::Pendulum::run).
    ///
    /// ```
    /// use double_pendulum::{Form, FormVisitor, Method, Parameters, Pendulum, State};
    ///
    /// /// Computes the angle of rod 1 after a second.
    /// struct AfterOneSecond;
    ///
    /// impl FormVisitor for AfterOneSecond {
    ///     type Output = Result<f64, double_pendulum::Error>;
    ///
    ///     fn visit<F: Form>(self) -> Self::Output {
    ///         let pendulum = Pendulum::<f64>::new(&Parameters::equal_rods(1.0, 1.0, 9.81))?;
    ///         let mut run = pendulum.run::<F>(&State::at_rest(0.5, 0.5), 1.0 / 128.0)?;
    ///         run.advance(128)?;
    ///         Ok(run.state().a1)
    ///     }
    /// }
    ///
    /// let method = Method::from_name("rk4-fixed32").ok_or("no such method")?;
    /// let angle = method.visit(AfterOneSecond).ok_or("not in this crate")??;
    /// assert!(angle.abs() < 0.5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn visit<V: FormVisitor>(self, visitor: V) -> Option<V::Output> {
        Some(match self {
            Method::Rk4F64 => visitor.visit::<HamiltonF64>(),
            Method::Rk4F32 => visitor.visit::<HamiltonF32>(),
            Method::Rk4F32Direction => visitor.visit::<DirectionF32>(),
            Method::Rk4F32DirectionPlain => visitor.visit::<DirectionF32Plain>(),
            Method::Rk4Fixed32 => visitor.visit::<Fixed32>(),
            Method::Extrapolation8Fixed64 => visitor.visit::<Fixed64<8>>(),
            Method::Extrapolation10Fixed64 => visitor.visit::<Fixed64<10>>(),
            Method::Extrapolation12Fixed64 => visitor.visit::<Fixed64<12>>(),
            Method::Extrapolation16Fixed64 => visitor.visit::<Fixed64<16>>(),
            Method::Extrapolation12F64 => visitor.visit::<ExtrapolationF64<12>>(),
            Method::Extrapolation16F64 => visitor.visit::<ExtrapolationF64<16>>(),
            Method::ClosedFormF64 => visitor.visit::<ClosedFormF64>(),
            Method::ClosedFormF32 => visitor.visit::<ClosedFormF32>(),
            Method::Rk4F32Micromath | Method::TextbookF32 => return None,
        })
    }
}

/// A motion by a method of [`Method::DRAWN`] in 32 bits.
///
/// It takes a third of the memory of a motion in 64 bits. [`advance`](Self::advance) does not
/// report a motion that diverges; [`check`](Self::check) does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DrawnMotion32 {
    /// [`Method::ClosedFormF32`].
    ClosedFormF32(ClosedFormF32),
    /// [`Method::Rk4F32DirectionPlain`].
    Rk4F32DirectionPlain(DirectionF32Plain),
    /// [`Method::Rk4F32Direction`].
    Rk4F32Direction(DirectionF32),
    /// [`Method::Rk4Fixed32`].
    Rk4Fixed32(Fixed32),
}

/// A motion by the method of [`Method::DRAWN`] in 64 bits, `extrapolation10-fixed64`.
///
/// Order 8 has a shorter accuracy horizon. Order 12 costs 1.4 times as much, and its horizon is no
/// longer, because rounding errors end it.
pub type DrawnMotion64 = Fixed64<10>;

/// A motion by a method of [`Method::DRAWN`].
///
/// Its directions and momenta are `f32`.
#[expect(
    clippy::large_enum_variant,
    reason = "without a heap there is nowhere else to keep it"
)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DrawnMotion {
    /// The methods in 32 bits.
    In32Bits(DrawnMotion32),
    /// [`Method::Extrapolation10Fixed64`].
    Extrapolation10Fixed64(DrawnMotion64),
}

impl DrawnMotion32 {
    /// Creates the motion of a pendulum by `method` from its start, in steps of `dt` seconds. A
    /// negative `dt` runs backwards.
    ///
    /// # Errors
    ///
    /// Refuses what [`DrawnMotion::new`] refuses and, by [`Error::NotDrawn`], the method in 64
    /// bits.
    #[inline(never)] // Inlined, the motions of all kinds would share a stack frame.
    pub fn new(
        method: Method,
        parameters: &Parameters<f64>,
        start: &State<f64>,
        dt: f64,
    ) -> Result<Self, Error> {
        let Some(drawn) = method.drawn() else {
            return Err(Error::NotDrawn { method });
        };
        Ok(match drawn {
            DrawnMethod::ClosedFormF32 => {
                Self::ClosedFormF32(FormOperations::new(parameters, start, dt)?)
            }
            DrawnMethod::Rk4F32DirectionPlain => {
                Self::Rk4F32DirectionPlain(FormOperations::new(parameters, start, dt)?)
            }
            DrawnMethod::Rk4F32Direction => {
                Self::Rk4F32Direction(FormOperations::new(parameters, start, dt)?)
            }
            DrawnMethod::Rk4Fixed32 => {
                Self::Rk4Fixed32(FormOperations::new(parameters, start, dt)?)
            }
            // In 64 bits: `DrawnMotion::new` creates its motion.
            DrawnMethod::Extrapolation10Fixed64 => return Err(Error::NotDrawn { method }),
        })
    }

    /// Restarts the motion at `start`, with the same pendulum and the same constants, as
    /// [`FormOperations::started`] does. The energy of `start` must not be much larger than that
    /// of the first start, because the constants were chosen for that; this is not checked.
    /// `rk4-fixed32` has room for an eighth more.
    ///
    /// # Errors
    ///
    /// Refuses a `start` that is not finite or otherwise out of the range of the method. The motion
    /// is unchanged then.
    pub(crate) fn restart(&mut self, start: &State<f64>) -> Result<(), Error> {
        match self {
            Self::ClosedFormF32(motion) => *motion = motion.started(start)?,
            Self::Rk4F32DirectionPlain(motion) => *motion = motion.started(start)?,
            Self::Rk4F32Direction(motion) => *motion = motion.started(start)?,
            Self::Rk4Fixed32(motion) => *motion = motion.started(start)?,
        }
        Ok(())
    }

    /// Advances the motion by `steps` steps; 0 steps change nothing. A motion that diverges is not
    /// reported, and goes on without meaning or stops; [`check`](Self::check) it afterwards.
    ///
    /// `advance(a); advance(b)` is bit-identical to `advance(a + b)`.
    #[inline(never)] // Boards find the step by this name, to run it in memory.
    pub fn advance(&mut self, steps: u32) {
        match self {
            Self::ClosedFormF32(motion) => motion.advance(steps),
            Self::Rk4F32DirectionPlain(motion) => motion.advance(steps),
            Self::Rk4F32Direction(motion) => motion.advance(steps),
            Self::Rk4Fixed32(motion) => motion.advance(steps),
        }
    }

    /// Refuses a motion that has diverged, by [`Error::Diverged`]: its numbers are not finite or,
    /// in fixed point, were ever out of range. `rk4-fixed32` tests its range after every 32 steps
    /// since the start.
    ///
    /// In `f32` this is no check of the energy: a motion whose numbers are finite but meaningless
    /// is accepted.
    pub fn check(&self) -> Result<(), Error> {
        match self {
            Self::ClosedFormF32(motion) => motion.check(),
            Self::Rk4F32DirectionPlain(motion) => motion.check(),
            Self::Rk4F32Direction(motion) => motion.check(),
            Self::Rk4Fixed32(motion) => motion.check(),
        }
    }

    /// Returns the sine and cosine of both rods as words whose highest bit is the sign
    /// ([`DrawnMotion::sides`]).
    fn sides(&self) -> [[i32; 2]; 2] {
        match self {
            Self::ClosedFormF32(motion) => motion.sides(),
            Self::Rk4F32DirectionPlain(motion) => motion.sides(),
            Self::Rk4F32Direction(motion) => motion.sides(),
            Self::Rk4Fixed32(motion) => motion.sides(),
        }
    }

    /// Returns the directions of rod 1 and rod 2, (sin, cos) each. Their length is 1, except for
    /// the errors of the method; by the closed form it is 1 to within 4e-4.
    ///
    /// By RK4 in `f32` they may be up to half a step ahead of the [`state`](Self::state), or behind
    /// it. A diverged motion need not show it: in fixed point its directions are finite. Call
    /// [`check`](Self::check).
    pub fn directions(&self) -> [Direction<f32>; 2] {
        self.directions_in()
    }

    /// Returns the [`directions`](Self::directions) in the numbers `Q`.
    pub(crate) fn directions_in<Q: Real>(&self) -> [Direction<Q>; 2] {
        match self {
            Self::ClosedFormF32(motion) => motion.directions(),
            Self::Rk4F32DirectionPlain(motion) => motion.directions(),
            Self::Rk4F32Direction(motion) => motion.directions(),
            Self::Rk4Fixed32(motion) => motion.directions(),
        }
    }

    /// Returns the momenta p1 and p2, kg m^2/s, at the time of the
    /// [`directions`](Self::directions). They are NaN if the motion has diverged in fixed point.
    pub(crate) fn momenta<Q: Real>(&self) -> [Q; 2] {
        match self {
            Self::ClosedFormF32(motion) => motion.momenta(),
            Self::Rk4F32DirectionPlain(motion) => motion.momenta(),
            Self::Rk4F32Direction(motion) => motion.momenta(),
            Self::Rk4Fixed32(motion) => motion.momenta(),
        }
    }

    /// Returns the canonical state in SI units at the number of steps times dt. The angles are
    /// within [-pi, pi]; by the closed form they include whole turns.
    ///
    /// In fixed point all its numbers are NaN once [`check`](Self::check) refuses the motion; until
    /// then, a motion that has left its range may look valid. If it has diverged in `f32`, some may
    /// be NaN or infinite.
    pub fn state(&self) -> State<f64> {
        match self {
            Self::ClosedFormF32(motion) => motion.state(),
            Self::Rk4F32DirectionPlain(motion) => motion.state(),
            Self::Rk4F32Direction(motion) => motion.state(),
            Self::Rk4Fixed32(motion) => motion.state(),
        }
    }

    /// Returns the energy above rest, J.
    fn energy_above_rest(&self, pendulum: &Pendulum<f64>) -> f64 {
        match self {
            Self::ClosedFormF32(motion) => motion.energy_above_rest(pendulum),
            Self::Rk4F32DirectionPlain(motion) => motion.energy_above_rest(pendulum),
            Self::Rk4F32Direction(motion) => motion.energy_above_rest(pendulum),
            Self::Rk4Fixed32(motion) => motion.energy_above_rest(pendulum),
        }
    }

    /// Returns true if the angles of the [`state`](Self::state) include whole turns.
    fn has_turns(&self) -> bool {
        match self {
            Self::ClosedFormF32(_) => ClosedFormF32::HAS_TURNS,
            Self::Rk4F32DirectionPlain(_) => DirectionF32Plain::HAS_TURNS,
            Self::Rk4F32Direction(_) => DirectionF32::HAS_TURNS,
            Self::Rk4Fixed32(_) => Fixed32::HAS_TURNS,
        }
    }
}

impl DrawnMotion {
    /// Creates the motion of a pendulum by `method` from its start, in steps of `dt` seconds. A
    /// negative `dt` runs backwards.
    ///
    /// # Errors
    ///
    /// Refuses:
    ///
    /// - a step that is NaN or infinite or, by [`Error::OutOfRange`], zero, subnormal or too large
    ///   in the method's numbers (`f64` for fixed point and the closed form);
    /// - a start that is not finite;
    /// - masses and lengths that are not positive and finite, gravity that is negative or not
    ///   finite and, by the closed form, a pendulum without gravity;
    /// - a pendulum or start out of the range of the method's numbers;
    /// - in fixed point, a step that is too long: [`Error::TooLarge`] contains the longest, s;
    /// - by the closed form, a start from which an angle may exceed 2^31 - 1 turns;
    /// - by [`Error::NotDrawn`], methods that are not in [`Method::DRAWN`].
    ///
    /// Unlike [`Pendulum::run`](crate::Pendulum::run), RK4 and extrapolation accept a start of any
    /// number of turns. RK4 in `f32`, and extrapolation up to its own limit, accept a step beyond
    /// the limit of stability.
    #[inline(never)] // Inlined, the motions of all kinds would share a stack frame.
    pub fn new(
        method: Method,
        parameters: &Parameters<f64>,
        start: &State<f64>,
        dt: f64,
    ) -> Result<Self, Error> {
        if method == Method::Extrapolation10Fixed64 {
            FormOperations::new(parameters, start, dt).map(Self::Extrapolation10Fixed64)
        } else {
            DrawnMotion32::new(method, parameters, start, dt).map(Self::In32Bits)
        }
    }

    /// Advances the motion by `steps` steps; 0 steps change nothing. A motion that diverges is not
    /// reported, and goes on without meaning or stops; [`check`](Self::check) it afterwards.
    ///
    /// `advance(a); advance(b)` is bit-identical to `advance(a + b)`.
    #[inline(never)] // Boards find the step by this name, to run it in memory.
    pub fn advance(&mut self, steps: u32) {
        match self {
            Self::In32Bits(motion) => motion.advance(steps),
            Self::Extrapolation10Fixed64(motion) => motion.advance(steps),
        }
    }

    /// Refuses a motion that has diverged, by [`Error::Diverged`]: its numbers are not finite or,
    /// in fixed point, were ever out of range. `rk4-fixed32` tests its range after every 32 steps
    /// since the start, `extrapolation10-fixed64` after every step.
    ///
    /// In `f32` this is no check of the energy: a motion whose numbers are finite but meaningless
    /// is accepted.
    pub fn check(&self) -> Result<(), Error> {
        match self {
            Self::In32Bits(motion) => motion.check(),
            Self::Extrapolation10Fixed64(motion) => motion.check(),
        }
    }

    /// Returns the sine and cosine of both rods, `[[sin a1, cos a1], [sin a2, cos a2]]`, as words
    /// whose highest bit is the sign; a zero may have either. They are those at the time of the
    /// [`directions`](Self::directions). The other bits are in the format of the method's numbers:
    /// in 64 bits they are the upper half of a number. The words of a diverged motion are
    /// arbitrary.
    #[must_use]
    pub fn sides(&self) -> [[i32; 2]; 2] {
        match self {
            Self::In32Bits(motion) => motion.sides(),
            Self::Extrapolation10Fixed64(motion) => motion.sides(),
        }
    }

    /// Returns the directions of rod 1 and rod 2, (sin, cos) each. Their length is 1, except for
    /// the errors of the method; by the closed form it is 1 to within 4e-4.
    ///
    /// By RK4 in `f32` they may be up to half a step ahead of the [`state`](Self::state), or behind
    /// it. A diverged motion need not show it: in fixed point its directions are finite. Call
    /// [`check`](Self::check).
    #[must_use]
    pub fn directions(&self) -> [Direction<f32>; 2] {
        match self {
            Self::In32Bits(motion) => motion.directions(),
            Self::Extrapolation10Fixed64(motion) => motion.directions(),
        }
    }

    /// Returns the momenta p1 and p2, kg m^2/s, at the time of the
    /// [`directions`](Self::directions).
    ///
    /// In fixed point they are NaN once [`check`](Self::check) refuses the motion. They may be NaN
    /// or infinite if it has diverged in `f32`, and are infinite if they do not fit an `f32`.
    #[must_use]
    pub fn momenta(&self) -> [f32; 2] {
        match self {
            Self::In32Bits(motion) => motion.momenta(),
            Self::Extrapolation10Fixed64(motion) => motion.momenta(),
        }
    }

    /// Returns the canonical state in SI units at the number of steps times dt. The angles are
    /// within [-pi, pi]; by the closed form they include whole turns.
    ///
    /// In fixed point all its numbers are NaN once [`check`](Self::check) refuses the motion; until
    /// then, a motion that has left its range may look valid. If it has diverged in `f32`, some may
    /// be NaN or infinite.
    #[must_use]
    pub fn state(&self) -> State<f64> {
        match self {
            Self::In32Bits(motion) => motion.state(),
            Self::Extrapolation10Fixed64(motion) => motion.state(),
        }
    }

    /// Returns the energy above that of hanging at rest, J, as the method carries it: nothing more
    /// is rounded to `f32`. It is that at the time of the [`directions`](Self::directions).
    ///
    /// `pendulum` must be the pendulum of this motion; this is not checked. The energy is never
    /// negative. By the closed form it is that of the [`state`](Self::state), which is not
    /// constant. In fixed point it is NaN once [`check`](Self::check) refuses the motion. It may be
    /// NaN or infinite if the motion has diverged in `f32`.
    #[must_use]
    pub fn energy_above_rest(&self, pendulum: &Pendulum<f64>) -> f64 {
        match self {
            Self::In32Bits(motion) => motion.energy_above_rest(pendulum),
            Self::Extrapolation10Fixed64(motion) => motion.energy_above_rest(pendulum),
        }
    }

    /// Returns true if the angles of the [`state`](Self::state) include whole turns: of the methods
    /// for drawing, only the closed form has them.
    #[must_use]
    pub fn has_turns(&self) -> bool {
        match self {
            Self::In32Bits(motion) => motion.has_turns(),
            Self::Extrapolation10Fixed64(_) => DrawnMotion64::HAS_TURNS,
        }
    }
}
