//! A motion carried out as a plan has it.

use super::cost::Way;
use super::run::{AnyRun, Directions};
use crate::error::Error;
use crate::methods::Turns;
use crate::pendulum::{Motion, Parameters, Pendulum, State};
use crate::table::Method;

/// A motion, frame by frame, by the method that was chosen for it: bit-identical to what the search looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedRun {
    way: Way,
    rate: u16,
    /// Frames since the start.
    frame: u64,
    run: AnyRun,
    turns: [Turns; 2],
}

impl PlannedRun {
    /// At `start`, with `rate` frames to a second. No steps count as one.
    ///
    /// Refuses what [`Pendulum::run`] refuses, what has no normal modes if it is the closed form, and a method
    /// that is none of [`Method::DRAWN`].
    #[inline(never)] // one copy
    #[doc(hidden)]
    pub fn new(parameters: &Parameters<f64>, start: &Motion<f64>, rate: u16, way: Way) -> Result<Self, Error> {
        start.check()?;
        let is_closed = way.method == Method::ClosedFormF32;
        let steps = if way.steps == 0 || is_closed { 1 } else { way.steps };
        let state = Pendulum::new(parameters)?.to_state(start);
        let run = AnyRun::new(way.method, &(*parameters, state), f64::from(rate) * f64::from(steps))?;
        let turns = Turns::of(state.angles(), run.sides());
        Ok(Self { way: Way { steps, ..way }, rate, frame: 0, run, turns })
    }

    #[doc(hidden)]
    #[must_use]
    pub fn way(&self) -> Way {
        self.way
    }

    /// Moves on by so many frames; [`Error::Diverged`] if that has led out of the finite numbers, and ever after.
    #[inline(never)] // never inlined, to avoid a second copy
    pub fn advance(&mut self, frames: u32) -> Result<(), Error> {
        for _ in 0..frames.saturating_mul(self.way.steps) {
            self.run.advance(1);
            Turns::observe(&mut self.turns, self.run.sides());
        }
        self.frame += u64::from(frames);
        self.run.check()
    }

    /// Frames since the start.
    #[doc(hidden)]
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// Seconds since the start.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.frame as f64 / f64::from(self.rate)
    }

    /// Where the rods point, (sin, cos) each.
    #[must_use]
    pub fn directions(&self) -> Directions {
        self.run.directions()
    }

    /// Both angles with all their turns, rad, when the rods point to the [`directions`](Self::directions).
    #[must_use]
    pub fn angles(&self) -> [f32; 2] {
        let ([turns1, turns2], [direction1, direction2]) = (&self.turns, self.directions());
        [turns1.angle(direction1), turns2.angle(direction2)]
    }

    /// The canonical state in SI units when the rods point to the [`directions`](Self::directions), rounded to `f32`, the angles
    /// with all their turns: what a picture needs, and far cheaper than [`state`](Self::state) where `f64` is software.
    #[inline(never)]
    #[doc(hidden)]
    #[must_use]
    pub fn rounded_state(&self) -> State<f32> {
        let ([a1, a2], [p1, p2]) = (self.angles(), self.run.momenta());
        State { a1, a2, p1, p2 }
    }

    /// The canonical state in SI units to the last digit carried, the angles with all their turns.
    #[must_use]
    #[inline(never)]
    pub fn state(&self) -> State<f64> {
        Turns::unwrap(&self.turns, self.run.state())
    }
}
