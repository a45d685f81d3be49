//! The motion that a plan computes.

use super::{Problem, Stepping};
use crate::error::Error;
use crate::methods::{
    ClosedFormF32, DirectionF32, DirectionF32Plain, Fixed32, Fixed64, Form, Turns,
};
use crate::pendulum::{Direction, Parameters, Pendulum, State};
use crate::table::Method;

/// The order of the steps in 64 bits of fixed point.
///
/// Order 8 has a shorter horizon. Order 12 costs 1.4 times as much, and its horizon is no longer,
/// because rounding errors end it.
const ORDER: u32 = Method::Extrapolation10Fixed64.order();

/// The directions of both rods, (sin, cos) each, for drawing.
#[doc(hidden)]
pub type Directions = [Direction<f32>; 2];

/// The only run in 64 bits that plans use.
pub(super) type DoubleRun = Fixed64<ORDER>;

/// A motion in 32 bits by a method of [`Method::DRAWN`].
///
/// Its results are `f32`. It takes a third of the memory of a motion in 64 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum SingleRun {
    ClosedForm(ClosedFormF32),
    DirectionPlain(DirectionF32Plain),
    Direction(DirectionF32),
    Fixed32(Fixed32),
}

/// A motion by a method of [`Method::DRAWN`]. Its results are `f32`.
#[expect(
    clippy::large_enum_variant,
    reason = "without a heap there is nowhere else to keep it"
)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AnyRun {
    Single(SingleRun),
    Double(DoubleRun),
}

/// Evaluates `$body` with the run in 32 bits, of any method, as `$run`.
macro_rules! with_single {
    ($any:expr, $run:ident => $body:expr) => {
        match $any {
            SingleRun::ClosedForm($run) => $body,
            SingleRun::DirectionPlain($run) => $body,
            SingleRun::Direction($run) => $body,
            SingleRun::Fixed32($run) => $body,
        }
    };
}

/// Evaluates `$body` with the run, of any method, as `$run`.
macro_rules! with {
    ($any:expr, $run:ident => $body:expr) => {
        match $any {
            AnyRun::Single(single) => with_single!(single, $run => $body),
            AnyRun::Double($run) => $body,
        }
    };
}

impl SingleRun {
    /// Creates the motion of a pendulum from its start, in `per_second` steps per second.
    ///
    /// # Errors
    ///
    /// Refuses the inputs that [`Pendulum::run`](crate::Pendulum::run) refuses, for the closed form
    /// a pendulum without normal modes, and methods that are not in [`Method::DRAWN`] or not in 32
    /// bits.
    #[inline(never)] // Inlined, the motions of all kinds would share a stack frame.
    pub fn new(
        method: Method,
        (parameters, start): &(Parameters<f64>, State<f64>),
        per_second: f64,
    ) -> Result<Self, Error> {
        let dt = 1.0 / per_second;
        Ok(match method {
            Method::ClosedFormF32 => Self::ClosedForm(Form::new(parameters, start, dt)?),
            Method::Rk4F32DirectionPlain => Self::DirectionPlain(Form::new(parameters, start, dt)?),
            Method::Rk4F32Direction => Self::Direction(Form::new(parameters, start, dt)?),
            Method::Rk4Fixed32 => Self::Fixed32(Form::new(parameters, start, dt)?),
            method => return Err(Error::NotDrawn { method }),
        })
    }

    #[inline(never)] // Not inlined: each caller would contain every method.
    pub fn advance(&mut self, steps: u32) {
        with_single!(self, run => run.advance(steps));
    }

    pub fn check(&self) -> Result<(), Error> {
        with_single!(self, run => run.check())
    }

    #[inline(never)]
    pub fn directions(&self) -> Directions {
        with_single!(self, run => run.directions())
    }

    /// Returns the canonical state in SI units, the angles without whole turns.
    #[inline(never)]
    pub fn state(&self) -> State<f64> {
        with_single!(self, run => run.state())
    }
}

impl AnyRun {
    /// Creates the motion of a pendulum from its start, in `per_second` steps per second.
    ///
    /// # Errors
    ///
    /// Refuses the inputs that [`Pendulum::run`](crate::Pendulum::run) refuses, for the closed form
    /// a pendulum without normal modes, and methods that are not in [`Method::DRAWN`].
    #[inline(never)] // Inlined, the motions of all kinds would share a stack frame.
    pub fn new(
        method: Method,
        given: &(Parameters<f64>, State<f64>),
        per_second: f64,
    ) -> Result<Self, Error> {
        if method == Method::Extrapolation10Fixed64 {
            let (parameters, start) = given;
            Form::new(parameters, start, 1.0 / per_second).map(Self::Double)
        } else {
            SingleRun::new(method, given, per_second).map(Self::Single)
        }
    }

    #[inline(never)] // Not inlined: each caller would contain every method.
    pub fn advance(&mut self, steps: u32) {
        match self {
            Self::Single(run) => run.advance(steps),
            Self::Double(run) => run.advance(steps),
        }
    }

    pub fn check(&self) -> Result<(), Error> {
        with!(self, run => run.check())
    }

    #[inline(never)]
    pub fn sides(&self) -> [[i32; 2]; 2] {
        with!(self, run => run.sides())
    }

    #[inline(never)]
    pub fn directions(&self) -> Directions {
        with!(self, run => run.directions())
    }

    /// Returns the canonical state in SI units, the angles without whole turns.
    #[inline(never)]
    pub fn state(&self) -> State<f64> {
        with!(self, run => run.state())
    }
}

/// A motion in progress, frame by frame, by the method of a plan.
///
/// It is bit-identical to the motion that the search has measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedRun {
    stepping: Stepping,
    rate: u16,
    /// The number of frames since the start.
    frame: u64,
    run: AnyRun,
    turns: [Turns; 2],
}

impl PlannedRun {
    /// Creates the motion of `problem` at its start. A step count of 0 counts as 1.
    ///
    /// # Errors
    ///
    /// Refuses the inputs that [`Pendulum::run`] refuses, for the closed form a pendulum without
    /// normal modes, and methods that are not in [`Method::DRAWN`].
    #[inline(never)] // Not inlined, to save flash.
    #[doc(hidden)]
    pub fn new(
        &Problem {
            pendulum,
            start,
            rate,
            ..
        }: &Problem,
        stepping: Stepping,
    ) -> Result<Self, Error> {
        start.check()?;
        let is_closed = stepping.method == Method::ClosedFormF32;
        let steps = if stepping.steps == 0 || is_closed {
            1
        } else {
            stepping.steps
        };

        let state = Pendulum::new(&pendulum)?.to_state(&start);
        let run = AnyRun::new(
            stepping.method,
            &(pendulum, state),
            f64::from(rate) * f64::from(steps),
        )?;

        let turns = Turns::of(state.angles(), run.sides())?;
        Ok(Self {
            stepping: Stepping { steps, ..stepping },
            rate,
            frame: 0,
            run,
            turns,
        })
    }

    #[doc(hidden)]
    #[must_use]
    pub fn stepping(&self) -> Stepping {
        self.stepping
    }

    /// Advances the motion by `frames` frames.
    ///
    /// # Errors
    ///
    /// Returns [`Error::Diverged`] if the motion has left the finite numbers. Every later call then
    /// returns it, too.
    #[inline(never)] // Not inlined, to save flash.
    pub fn advance(&mut self, frames: u32) -> Result<(), Error> {
        for _ in 0..frames {
            for _ in 0..self.stepping.steps {
                self.run.advance(1);
                Turns::observe(&mut self.turns, self.run.sides());
            }
        }

        self.frame += u64::from(frames);
        self.run.check()
    }

    /// The number of frames since the start.
    #[doc(hidden)]
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// Returns the time since the start, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.frame as f64 / f64::from(self.rate)
    }

    /// Returns the directions of both rods, (sin, cos) each.
    #[must_use]
    pub fn directions(&self) -> Directions {
        self.run.directions()
    }

    /// Returns both angles, rad, including whole turns, at the time of the
    /// [`directions`](Self::directions).
    #[must_use]
    pub fn angles(&self) -> [f32; 2] {
        let ([turns1, turns2], [direction1, direction2]) = (&self.turns, self.directions());
        [turns1.angle(direction1), turns2.angle(direction2)]
    }

    /// Returns the canonical state in SI units, rounded to `f32`, at the time of the
    /// [`directions`](Self::directions). The angles include whole turns.
    ///
    /// This is enough for a picture, and costs far less than [`state`](Self::state) on a processor
    /// whose `f64` is software.
    #[inline(never)]
    #[doc(hidden)]
    #[must_use]
    pub fn rounded_state(&self) -> State<f32> {
        let ([a1, a2], [p1, p2]) = (self.angles(), with!(&self.run, run => run.momenta()));
        State { a1, a2, p1, p2 }
    }

    /// Returns the energy above rest, J, of the motion as it is carried: nothing is rounded to
    /// `f32`. `pendulum` is the pendulum of the problem.
    #[inline(never)]
    #[doc(hidden)]
    #[must_use]
    pub fn energy_above_rest(&self, pendulum: &Pendulum<f64>) -> f64 {
        with!(&self.run, run => run.energy_above_rest(pendulum))
    }

    /// Returns the canonical state in SI units, with all digits that the method carries. The angles
    /// include whole turns.
    #[must_use]
    #[inline(never)]
    pub fn state(&self) -> State<f64> {
        Turns::unwrap(&self.turns, self.run.state())
    }
}
