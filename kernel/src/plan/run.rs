//! A motion by any method that a plan chooses from, and how far two of its frames are apart.

use super::cost::{Costs, ORDER, Way};
use crate::error::Error;
use crate::methods::{ClosedFormF32, DirectionF32, DirectionF32Plain, Fixed32, Fixed64, Form};
use crate::pendulum::{Direction, Parameters, State};
use crate::table::Method;

/// The directions of both rods as they would be drawn.
#[doc(hidden)]
pub type Directions = [Direction<f32>; 2];

/// A motion by any of [`Method::DRAWN`], read in `f32`: the one place that knows which type computes each.
#[expect(clippy::large_enum_variant, reason = "without a heap there is nowhere else to keep it")]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum AnyRun {
    ClosedForm(ClosedFormF32),
    DirectionPlain(DirectionF32Plain),
    Direction(DirectionF32),
    Fixed32(Fixed32),
    Fixed64(Fixed64<ORDER>),
}

/// `$body` with the run of whichever method as `$run`.
macro_rules! with {
    ($any:expr, $run:ident => $body:expr) => {
        match $any {
            AnyRun::ClosedForm($run) => $body,
            AnyRun::DirectionPlain($run) => $body,
            AnyRun::Direction($run) => $body,
            AnyRun::Fixed32($run) => $body,
            AnyRun::Fixed64($run) => $body,
        }
    };
}

impl AnyRun {
    /// A pendulum from its start, with so many steps a second.
    ///
    /// Refuses what [`Pendulum::run`](crate::Pendulum::run) refuses, what has no normal modes if the method is the closed form,
    /// and a method that is none of [`Method::DRAWN`].
    #[inline(never)] // each kind's preparations would stand side by side on the stack
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
            Method::Extrapolation10Fixed64 => Self::Fixed64(Form::new(parameters, start, dt)?),
            method => return Err(Error::NotDrawn { method }),
        })
    }

    #[inline(never)] // never inlined: a copy of every method for each caller
    pub fn advance(&mut self, steps: u32) {
        with!(self, run => run.advance(steps));
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

    #[inline(never)]
    pub fn momenta(&self) -> [f32; 2] {
        with!(self, run => run.momenta())
    }

    /// The canonical state, angles within a turn but in closed form.
    #[inline(never)]
    pub fn state(&self) -> State<f64> {
        with!(self, run => run.state())
    }
}

/// A motion that is prepared before its first step, and stepped from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    motion: Prepared,
    /// Steps to a frame, and those made since the last. The method is not said again: a board's stack is short of a few words.
    steps: u32,
    made: u32,
}

#[expect(clippy::large_enum_variant, reason = "as above")]
#[derive(Clone, Copy, Debug, PartialEq)]
enum Prepared {
    /// A pendulum and its start, others if these are refused, the method, and steps a second.
    NotYet([(Parameters<f64>, State<f64>); 2], Method, f64),
    Ready(AnyRun),
}

impl Run {
    /// A pendulum and its start, or the others if the first are refused, in this `way` with `rate` frames in a second.
    pub fn new(way: Way, given: [(Parameters<f64>, State<f64>); 2], rate: u16) -> Self {
        let Way { method, steps } = way;
        Self { motion: Prepared::NotYet(given, method, f64::from(rate) * f64::from(steps)), steps, made: 0 }
    }

    /// Prepares the steps; whether they were not.
    #[inline(never)]
    pub fn prepare(&mut self) -> Result<bool, Error> {
        let Prepared::NotYet([first, other], method, per_second) = &self.motion else { return Ok(false) };
        let run = AnyRun::new(*method, first, *per_second);
        self.motion = Prepared::Ready(run.or_else(|_| AnyRun::new(*method, other, *per_second))?);
        Ok(true)
    }

    fn method(&self) -> Method {
        match &self.motion {
            Prepared::NotYet(_, method, _) => *method,
            Prepared::Ready(AnyRun::ClosedForm(_)) => Method::ClosedFormF32,
            Prepared::Ready(AnyRun::DirectionPlain(_)) => Method::Rk4F32DirectionPlain,
            Prepared::Ready(AnyRun::Direction(_)) => Method::Rk4F32Direction,
            Prepared::Ready(AnyRun::Fixed32(_)) => Method::Rk4Fixed32,
            Prepared::Ready(AnyRun::Fixed64(_)) => Method::Extrapolation10Fixed64,
        }
    }

    /// What a frame costs.
    pub fn cost(&self, costs: &Costs) -> f32 {
        costs.of_frame(self.method(), self.steps)
    }

    /// Makes steps towards the next frame, as many as are left or as `cost` pays for, one at least. What they cost: 0 if nothing
    /// was left to do.
    #[inline(never)]
    pub fn advance(&mut self, costs: &Costs, cost: f32) -> f32 {
        let paid = (cost / costs.of_frame(self.method(), 1)) as u32;
        let left = self.steps.saturating_sub(self.made);
        let steps = left.min(if paid > 0 { paid } else { 1 });
        if let Prepared::Ready(motion) = &mut self.motion {
            motion.advance(steps);
        }
        self.made += steps;
        costs.of_frame(self.method(), steps)
    }

    /// The frame, when nothing is left to do; the next steps lead to the next. NaN if the motion is lost: it may have left its
    /// range where its directions do not show it.
    #[inline(never)]
    pub fn frame(&mut self) -> Directions {
        self.made = 0;
        match &self.motion {
            Prepared::Ready(motion) if motion.check().is_ok() => motion.directions(),
            _ => [[f32::NAN; 2]; 2],
        }
    }
}

/// How far the farther of the two bobs is off, or bob 2 as seen from bob 1, where the rods are as long as `rods`, in their
/// unit; NaN if anything is.
///
/// The last keeps curves of the angles right, too: opposite errors of both may leave bob 2 where it belongs.
#[inline(never)] // one copy
pub(super) fn distance(rods: [f32; 2], a: &Directions, b: &Directions) -> f32 {
    let difference = |rod: usize, axis: usize| rods[rod] * (a[rod][axis] - b[rod][axis]);
    let [bob1, relative] = [0, 1].map(|rod| [difference(rod, 0), difference(rod, 1)]);
    let bob2 = [bob1[0] + relative[0], bob1[1] + relative[1]];
    let [bob1, relative, bob2] = [bob1, relative, bob2].map(|[x, y]| x * x + y * y);
    libm::sqrtf(greater(greater(bob1, relative), bob2))
}

/// The greater; NaN if either is.
pub(super) fn greater(a: f32, b: f32) -> f32 {
    if a > b || a.is_nan() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bob 2 is where both rods lead, and may be less far off than either.
    #[test]
    fn the_farthest_of_what_is_seen_counts() {
        let from = |a: Directions| distance([2.0, 3.0], &a, &[[0.0; 2]; 2]);
        assert_eq!(from([[1.0, 0.0], [0.0, 1.0]]), 13.0_f32.sqrt());
        assert_eq!(from([[0.5, 0.0], [1.0, 0.0]]), 4.0);
        assert_eq!(from([[3.0, 0.0], [-1.0, 0.0]]), 6.0);
        assert_eq!(from([[0.0, 1.0], [0.0, -2.0]]), 6.0);
        assert!(from([[0.0, f32::NAN], [0.0, 1.0]]).is_nan());
    }
}
